#include "scenes/given_rays.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <span>
#include <string>
#include <system_error>

#include "scenes/npy.h"
#include "scenes/vertex_values.h"
#include "sim/error.h"
#include "sim/input_files.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

static_assert(std::endian::native == std::endian::little, "arrays are read as they lie in their file");

constexpr std::uint64_t columns = 8;          // without that of any hits
constexpr double shortest_direction = 1e-30;  // the longest is largest_coordinate

/// A file of rays whose header fits its size.
class RayFile {
 public:
  explicit RayFile(const std::filesystem::path& path) : name_(sim::shown(path.string())) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) {
      fail(std::filesystem::exists(path, failed) ? "it is no regular file" : "there is no such file");
    }
    in_.open(path, std::ios::binary);
    if (!in_) {
      fail("it cannot be read");
    }
    const std::uintmax_t size = std::filesystem::file_size(path, failed);
    NpyHeader header;
    try {
      header = read_npy_header(in_);
    } catch (const sim::UserError& error) {
      fail(error.what());
    }
    check(header);
    const std::uint64_t needed = header.bytes + rays_ * row_bytes();
    if (failed || size != needed) {
      fail("it has " + std::to_string(size) + " bytes, and " + std::to_string(rays_) + " rays of " +
           std::to_string(row_bytes()) + " bytes need " + std::to_string(needed));
    }
    sim::note_input(path);
  }

  [[nodiscard]] std::uint64_t rays() const { return rays_; }
  [[nodiscard]] bool has_kinds() const { return columns_ > columns; }

  [[noreturn]] void fail(const std::string& what) const { throw sim::UserError(name_ + ": " + what); }

  /// The next rows, as many as `into` has; the ninth number is 0 where the file has none.
  void read(std::span<std::array<double, columns + 1>> into) {
    raw_.resize(into.size() * row_bytes());
    in_.read(raw_.data(), static_cast<std::streamsize>(raw_.size()));
    if (!in_) {
      fail("it cannot be read to its end");
    }
    const char* from = raw_.data();
    for (std::array<double, columns + 1>& row : into) {
      row.back() = 0.0;
      for (std::size_t i = 0; i < columns_; ++i, from += element_) {
        row.at(i) = number_at(from);
      }
    }
  }

 private:
  void check(const NpyHeader& header) {
    if (header.type != "<f4" && header.type != "<f8") {
      fail("its elements are " + (header.type.empty() ? "structures" : "of type " + sim::shown(header.type)) +
           "; rays are float32 or float64 with the lowest byte first ('<f4', '<f8')");
    }
    element_ = header.type == "<f4" ? sizeof(float) : sizeof(double);
    if (header.shape.size() != 2 || header.shape[1] < columns || header.shape[1] > columns + 1) {
      std::string shape;
      for (const std::uint64_t size : header.shape) {
        shape += (shape.empty() ? "" : ", ") + std::to_string(size);
      }
      fail("its shape is (" + shape +
           "); rays are rows of 8 columns, origin, least distance, direction, greatest distance, or of 9 "
           "with 0 for the closest hit and 1 for any");
    }
    if (header.fortran) {
      fail(
          "it is in Fortran order, in which a ray's numbers are far apart; save "
          "numpy.ascontiguousarray(rays)");
    }
    rays_ = header.shape[0];
    columns_ = header.shape[1];
    if (rays_ == 0 || rays_ > most_given_rays) {
      fail(rays_ == 0 ? "it has no rays"
                      : "it has " + std::to_string(rays_) + " rays; at most " +
                            std::to_string(most_given_rays) + " are traced");
    }
  }

  [[nodiscard]] std::uint64_t row_bytes() const { return columns_ * element_; }

  [[nodiscard]] double number_at(const char* from) const {
    if (element_ == sizeof(double)) {
      double number = 0.0;
      std::memcpy(&number, from, sizeof number);
      return number;
    }
    float number = 0.0F;
    std::memcpy(&number, from, sizeof number);
    return static_cast<double>(number);
  }

  std::string name_;
  std::ifstream in_;
  std::uint64_t rays_ = 0;
  std::uint64_t columns_ = 0;
  std::uint64_t element_ = 0;  // bytes
  std::vector<char> raw_;
};

/// What is wrong with a ray; null: nothing.
const char* fault_of(const GivenRay& ray, double kind) {
  const auto largest = [](const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  };
  if (!is_usable(ray.origin)) {
    return "its origin is not finite or beyond 1e30";
  }
  if (!is_usable(ray.direction)) {
    return "its direction is not finite or longer than 1e30";
  }
  if (!(largest(ray.direction) >= shortest_direction)) {
    return largest(ray.direction) == 0.0 ? "its direction is 0" : "its direction is shorter than 1e-30";
  }
  if (!std::isfinite(ray.least) || ray.least < 0.0) {
    return "its least distance is negative or not finite";
  }
  if (!(ray.greatest >= ray.least)) {
    return std::isnan(ray.greatest) ? "its greatest distance is not a number"
                                    : "its greatest distance is below its least";
  }
  return kind == 0.0 || kind == 1.0 ? nullptr : "its ninth number is neither 0 (closest hit) nor 1 (any hit)";
}

}  // namespace

std::uint64_t count_rays(const std::filesystem::path& file) { return RayFile(file).rays(); }

GivenRays read_rays(const std::filesystem::path& file, const sim::MemoryBudget& memory) {
  RayFile from(file);
  memory.require(from.rays() * (sizeof(GivenRay) + 1), "the rays of image.rays take", "take fewer rays");
  GivenRays given;
  given.rays.reserve(from.rays());
  given.any.reserve(from.has_kinds() ? from.rays() : 0);
  std::vector<std::array<double, columns + 1>> block;
  constexpr std::uint64_t block_rays = 4096;
  while (given.rays.size() < from.rays()) {
    block.resize(std::min(block_rays, from.rays() - given.rays.size()));
    from.read(block);
    for (const std::array<double, columns + 1>& row : block) {
      const GivenRay ray{{row[0], row[1], row[2]}, row[3], {row[4], row[5], row[6]}, row[7]};
      if (const char* fault = fault_of(ray, row[8]); fault != nullptr) {
        from.fail("ray " + std::to_string(given.rays.size()) + " (counted from 0): " + fault);
      }
      given.rays.push_back(ray);
      if (from.has_kinds()) {
        given.any.push_back(row[8] != 0.0);
      }
    }
  }
  return given;
}

}  // namespace marti::scenes
