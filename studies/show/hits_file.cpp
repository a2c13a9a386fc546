#include "studies/show/hits_file.h"

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "scenes/npy.h"

namespace marti::studies::show {

namespace {

constexpr std::int64_t nothing = -1;
constexpr std::int64_t something = -2;

// As it lies in the file.
struct Entry {
  double distance = std::numeric_limits<double>::infinity();
  std::int64_t primitive = nothing;
  std::array<double, 3> weights{};
};
static_assert(sizeof(Entry) == 40 && std::endian::native == std::endian::little);

Entry entry_of(const processors::program::GivenHit& given) {
  const accel::Hit& hit = given.hit;
  if (hit.found()) {
    return {hit.t, hit.primitive, {{hit.u, hit.v, hit.w}}};
  }
  return given.any ? Entry{std::numeric_limits<double>::quiet_NaN(), something, {}} : Entry{};
}

}  // namespace

std::string hits_file(const processors::program::Frame& frame, std::uint64_t rays) {
  std::string file =
      scenes::npy_header("[('distance', '<f8'), ('primitive', '<i8'), ('weights', '<f8', (3,))]", rays);
  file.reserve(file.size() + rays * sizeof(Entry));
  for (std::uint64_t ray = 0; ray < rays; ++ray) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(Entry)>>(entry_of(frame.hits[ray]));
    file.append(bytes.data(), bytes.size());
  }
  return file;
}

}  // namespace marti::studies::show
