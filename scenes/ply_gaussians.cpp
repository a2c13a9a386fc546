#include "scenes/ply_gaussians.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "scenes/binary_power.h"
#include "scenes/gaussian_proxies.h"
#include "scenes/vertex_values.h"

namespace marti::scenes {

namespace {

constexpr double largest_log_scale = 32.0;

// Where a value goes: its place among the values of a Gaussian.
constexpr std::size_t opacity_at = 3;
constexpr std::size_t scale_at = 4;
constexpr std::size_t rotation_at = 7;
constexpr std::size_t first_harmonic = 11;
constexpr std::size_t no_place = first_harmonic + 3 * 16;

double exponential(double x) { return x <= 0.0 ? two_to(x * log_two_of_e) : 1.0 / two_to(-x * log_two_of_e); }

/// The inverse of the logit.
double share_of(double x) {
  const double small = exponential(-std::abs(x));
  return (x < 0.0 ? small : 1.0) / (1.0 + small);
}

class GaussianReader {
 public:
  GaussianReader(const PlyElement& vertex, PlyValues& values, const SourceFile& file)
      : vertex_(vertex), values_(values), file_(file), places_(vertex.properties.size(), no_place) {
    give_places("", 0, {"x", "y", "z", "opacity"});
    give_places("scale_", scale_at, {"0", "1", "2"});
    give_places("rot_", rotation_at, {"0", "1", "2", "3"});
    find_harmonics();
  }

  Gaussians read(std::uint64_t& unseen) {
    file_.take_memory(vertex_.count * (sizeof(Gaussian) + 3 * all_.terms() * sizeof(float)) +
                          bytes_of_proxies(vertex_.count, file_.options().instances),
                      "its Gaussians take");
    all_.shapes.reserve(vertex_.count);
    all_.coefficients.reserve(vertex_.count * 3 * all_.terms());
    for (std::uint64_t i = 0; i < vertex_.count; ++i) {
      read_entry(i);
      if (const std::optional<Gaussian> gaussian = gaussian_of(splat(i))) {
        all_.add(*gaussian);
        for (std::size_t k = 0; k < std::size_t{3} * all_.terms(); ++k) {
          all_.coefficients.push_back(static_cast<float>(given_[first_harmonic + k]));
        }
      } else {
        ++unseen;
      }
    }
    return std::move(all_);
  }

 private:
  void give_place(const std::string& name, std::size_t place) {
    const auto found = vertex_.find(name);
    if (!found || vertex_.properties[*found].count) {
      file_.fail("its vertices are Gaussians, and lack the property " + name + ", or it is a list");
    }
    places_[*found] = place;
  }

  void give_places(const std::string& begin, std::size_t first, const std::vector<std::string>& ends) {
    for (std::size_t i = 0; i < ends.size(); ++i) {
      give_place(begin + ends[i], first + i);
    }
  }

  // In the file the first terms of all colours come first, then the others of red, of green and of blue.
  void find_harmonics() {
    const auto others =
        static_cast<std::size_t>(std::ranges::count_if(vertex_.properties, [](const PlyProperty& property) {
          return property.name.starts_with("f_rest_");
        }));
    while (all_.degree < largest_degree && std::size_t{3} * (all_.terms() - 1) < others) {
      ++all_.degree;
    }
    const std::size_t terms = all_.terms();
    if (others != 3 * (terms - 1)) {
      file_.fail("its Gaussians have " + std::to_string(others) +
                 " properties f_rest_; spherical harmonics of degree 0 to 3 have 0, 9, 24 or 45");
    }
    for (std::size_t channel = 0; channel < 3; ++channel) {
      give_place("f_dc_" + std::to_string(channel), first_harmonic + channel * terms);
      for (std::size_t term = 1; term < terms; ++term) {
        give_place("f_rest_" + std::to_string(channel * (terms - 1) + term - 1),
                   first_harmonic + channel * terms + term);
      }
    }
  }

  void read_entry(std::uint64_t number) {
    values_.begin(vertex_, number);
    for (std::size_t p = 0; p < places_.size(); ++p) {
      const PlyProperty& property = vertex_.properties[p];
      if (places_[p] == no_place) {
        for (std::uint64_t left = property.count ? values_.length(property) : 1; left > 0; --left) {
          values_.pass_over(property.type);
        }
        continue;
      }
      const double value = values_.value(property.type);
      given_[places_[p]] = value;
      if (!std::isfinite(value)) {
        fail(number, "its " + property.name + " is not finite");
      }
    }
    values_.end();
  }

  [[nodiscard]] Splat splat(std::uint64_t number) const {
    Splat splat;
    splat.center = {given_[0], given_[1], given_[2]};
    splat.opacity = share_of(given_[opacity_at]);
    splat.rotation = glm::dquat(given_[rotation_at], given_[rotation_at + 1], given_[rotation_at + 2],
                                given_[rotation_at + 3]);
    if (!is_usable(splat.center)) {
      fail(number, "its position is beyond 1e30");
    }
    const double length = glm::length(splat.rotation);
    if (!(length >= 1e-30 && length <= 1e30)) {
      fail(number, "its rotation, the quaternion rot_0 to rot_3, has a length below 1e-30 or beyond 1e30");
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double scale = given_[scale_at + static_cast<std::size_t>(axis)];
      if (!(std::abs(scale) <= largest_log_scale)) {
        fail(number,
             "its scale_" + std::to_string(axis) + ", the logarithm of a size, is not from -32 to 32");
      }
      splat.deviation[axis] = exponential(scale);
    }
    return splat;
  }

  [[noreturn]] void fail(std::uint64_t number, const std::string& what) const {
    values_.fail("vertex " + std::to_string(number) + ", a Gaussian: " + what);
  }

  const PlyElement& vertex_;
  PlyValues& values_;
  const SourceFile& file_;
  std::vector<std::size_t> places_;
  std::array<double, no_place + 1> given_{};
  Gaussians all_;
};

}  // namespace

bool holds_gaussians(const PlyElement& vertex) {
  return vertex.find("f_dc_0") || (vertex.find("scale_0") && vertex.find("rot_0"));
}

Gaussians read_gaussians(const PlyElement& vertex, PlyValues& values, const SourceFile& file,
                         std::uint64_t& unseen) {
  return GaussianReader(vertex, values, file).read(unseen);
}

}  // namespace marti::scenes
