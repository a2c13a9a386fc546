#include "memory/link_times.h"

#include "sim/avx2.h"

#ifdef MARTI_AVX2
#include <immintrin.h>
#endif

namespace marti::memory {

namespace {

#ifdef MARTI_AVX2
// As take_one_by_one(), four links at a time while the head finds all of them free. Returns how many links it
// has taken in this way.
[[gnu::target("avx2")]] std::size_t take_free_ones(std::uint64_t* free_at, std::size_t links,
                                                   Crossing& crossing) {
  const auto of = [](std::uint64_t time) { return static_cast<long long>(time); };
  const __m256i held = _mm256_set1_epi64x(of(crossing.held));
  const __m256i four_hops = _mm256_set1_epi64x(of(4 * crossing.hop));
  __m256i begin =
      _mm256_setr_epi64x(of(crossing.head), of(crossing.head + crossing.hop),
                         of(crossing.head + 2 * crossing.hop), of(crossing.head + 3 * crossing.hop));
  std::size_t link = 0;
  for (; link + 4 <= links; link += 4) {
    auto* const times = reinterpret_cast<__m256i*>(free_at + link);
    const __m256i later = _mm256_cmpgt_epi64(_mm256_loadu_si256(times), begin);
    if (_mm256_testz_si256(later, later) == 0) {
      break;
    }
    _mm256_storeu_si256(times, _mm256_add_epi64(begin, held));
    begin = _mm256_add_epi64(begin, four_hops);
  }
  crossing.head += link * crossing.hop;
  return link;
}
#endif

}  // namespace

void LinkTimes::take_many(std::uint64_t* free_at, std::size_t links, Crossing& crossing) {
#ifdef MARTI_AVX2
  if (sim::has_avx2()) {
    while (links >= 4) {
      const std::size_t taken = take_free_ones(free_at, links, crossing);
      free_at += taken;
      links -= taken;
      const std::size_t next = std::min<std::size_t>(links, 4);
      take_one_by_one(free_at, next, crossing);
      free_at += next;
      links -= next;
    }
  }
#endif
  take_one_by_one(free_at, links, crossing);
}

}  // namespace marti::memory
