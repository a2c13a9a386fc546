// The lines that each set of a cache was asked for last since some moment, the newest first.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "memory/set_tags.h"

namespace marti::memory {

/// A list of at most `Depth` lines, a multiple of 4, for each set. A line is found and moved to the front
/// without an unpredictable branch.
template <std::uint32_t Depth>
class RecencyLists {
  static_assert(Depth >= 4 && Depth % 4 == 0 && Depth < 32);

 public:
  explicit RecencyLists(std::uint32_t sets) : index_(sets), lists_(sets) {}
  RecencyLists(const RecencyLists&) = delete;  // touched_ refers to lists_
  RecencyLists& operator=(const RecencyLists&) = delete;
  RecencyLists(RecencyLists&&) noexcept = default;
  RecencyLists& operator=(RecencyLists&&) noexcept = default;
  ~RecencyLists() = default;

  /// The place of `line` in its set's list, 0 for the newest; Depth when the list does not have it. Moves it
  /// to the front; the last line of a full list is lost.
  [[gnu::always_inline]] std::uint32_t touch(std::uint32_t line) {
    List& list = lists_[index_(line)];
    const std::uint32_t place = place_of(list, line);
    if (place == Depth) [[unlikely]] {
      insert(list, line);
    } else {
      move_to_front(list, line, place);
    }
    return place;
  }
  /// Whether `line` is the newest of its set's list.
  [[nodiscard]] [[gnu::always_inline]] bool newest(std::uint32_t line) const {
    return lists_[index_(line)].lines[0] == line;
  }
  /// Number of lines that the set of the line touched last had before, if touch() did not find that line.
  [[nodiscard]] std::uint32_t lines_before() const { return lines_before_; }

  /// Empties all lists.
  void clear() {
    for (List* const list : touched_) {
      *list = {};
    }
    touched_.clear();
  }

  /// Calls use(line, lines, number) for each set that was touched, in the order of the sets' first lines: a
  /// pointer to its lines, the newest first, how many there are, and how many were inserted.
  template <class Use>
  void for_each_touched(const Use& use) const {
    for (const List* const list : touched_) {
      use(list->lines.data(), size_of(*list), list->inserted);
    }
  }

 private:
  struct alignas(16) List {
    List() { lines.fill(no_line); }
    std::array<std::uint32_t, Depth> lines;
    std::uint32_t inserted = 0;  // at most Depth + 1
  };

  static std::uint32_t size_of(const List& list) { return list.inserted < Depth ? list.inserted : Depth; }

  [[gnu::noinline]] void insert(List& list, std::uint32_t line) {
    lines_before_ = size_of(list);
    if (list.inserted == 0) {
      touched_.push_back(&list);
    }
    if (list.inserted <= Depth) {
      ++list.inserted;
    }
    move_to_front(list, line, Depth - 1);
  }

#ifdef __SSE2__
  static __m128i* quad(List& list, std::uint32_t number) {
    return reinterpret_cast<__m128i*>(list.lines.data()) + number;
  }

  [[gnu::always_inline]] static std::uint32_t place_of(List& list, std::uint32_t line) {
    const __m128i wanted = _mm_set1_epi32(static_cast<int>(line));
    std::uint32_t found = 1U << Depth;
    for (std::uint32_t i = 0; i < Depth / 4; ++i) {
      const __m128i equal = _mm_cmpeq_epi32(_mm_load_si128(quad(list, i)), wanted);
      found |= static_cast<std::uint32_t>(_mm_movemask_ps(_mm_castsi128_ps(equal))) << (4 * i);
    }
    return static_cast<std::uint32_t>(std::countr_zero(found));
  }

  // Lines up to `place` move one place back, and `line` comes to the front.
  [[gnu::always_inline]] static void move_to_front(List& list, std::uint32_t line, std::uint32_t place) {
    __m128i before = _mm_cvtsi32_si128(static_cast<int>(line));
    const __m128i last = _mm_set1_epi32(static_cast<int>(place));
    __m128i places = _mm_set_epi32(3, 2, 1, 0);
    for (std::uint32_t i = 0; i < Depth / 4; ++i) {
      const __m128i here = _mm_load_si128(quad(list, i));
      const __m128i moved = _mm_or_si128(_mm_slli_si128(here, 4), before);
      const __m128i keeps = _mm_cmpgt_epi32(places, last);
      _mm_store_si128(quad(list, i),
                      _mm_or_si128(_mm_and_si128(keeps, here), _mm_andnot_si128(keeps, moved)));
      before = _mm_srli_si128(here, 12);
      places = _mm_add_epi32(places, _mm_set1_epi32(4));
    }
  }
#else
  static std::uint32_t place_of(const List& list, std::uint32_t line) {
    std::uint32_t place = 0;
    while (place < Depth && list.lines[place] != line) {
      ++place;
    }
    return place;
  }

  static void move_to_front(List& list, std::uint32_t line, std::uint32_t place) {
    for (; place > 0; --place) {
      list.lines[place] = list.lines[place - 1];
    }
    list.lines[0] = line;
  }
#endif

  SetIndex index_;
  std::vector<List> lists_;
  std::vector<List*> touched_;
  std::uint32_t lines_before_ = 0;
};

}  // namespace marti::memory
