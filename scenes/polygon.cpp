#include "scenes/polygon.h"

#include <cmath>
#include <limits>
#include <string>

#include "sim/error.h"

namespace marti::scenes {

namespace {

/// A sum of doubles without rounding error, as components of growing magnitude (Shewchuk, section 2.4).
class Expansion {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = value + parts_[i];
      const double virtual_part = sum - value;
      const double error = (value - (sum - virtual_part)) + (parts_[i] - virtual_part);
      if (error != 0.0) {
        parts_[kept++] = error;
      }
      value = sum;
    }
    if (value != 0.0 || kept == 0) {
      parts_[kept++] = value;
    }
    size_ = kept;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  [[nodiscard]] int sign() const {
    const double largest = size_ == 0 ? 0.0 : parts_[size_ - 1];
    return largest > 0.0 ? 1 : largest < 0.0 ? -1 : 0;
  }

 private:
  std::array<double, 16> parts_{};
  std::size_t size_ = 0;
};

double squared_distance(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = a - b;
  return d.x * d.x + d.y * d.y;
}

/// The corners not yet cut off, as a ring.
class Ring {
 public:
  explicit Ring(std::span<const glm::dvec2> corners)
      : corners_(corners), next_(corners.size()), previous_(corners.size()), is_ear_(corners.size()) {
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    find_ears();
  }
  [[nodiscard]] std::size_t next(std::size_t i) const { return next_[i]; }
  [[nodiscard]] std::size_t previous(std::size_t i) const { return previous_[i]; }

  /// The ear with the shortest diagonal, or the number of corners when there is no ear.
  [[nodiscard]] std::size_t best_ear() const {
    std::size_t best = corners_.size();
    double shortest = std::numeric_limits<double>::infinity();
    std::size_t i = start_;
    do {
      const double diagonal = squared_distance(corners_[previous_[i]], corners_[next_[i]]);
      if (is_ear_[i] && diagonal < shortest) {
        shortest = diagonal;
        best = i;
      }
      i = next_[i];
    } while (i != start_);
    return best;
  }
  void cut(std::size_t i) {
    next_[previous_[i]] = next_[i];
    previous_[next_[i]] = previous_[i];
    start_ = next_[i];
    is_ear_[previous_[i]] = ear_at(previous_[i]);
    is_ear_[next_[i]] = ear_at(next_[i]);
  }
  void find_ears() {
    std::size_t i = start_;
    do {
      is_ear_[i] = ear_at(i);
      i = next_[i];
    } while (i != start_);
  }
  /// A corner collinear with its neighbours, which can be cut off without changing the area.
  [[nodiscard]] std::size_t flat_corner() const {
    std::size_t i = start_;
    do {
      if (orientation(corners_[previous_[i]], corners_[i], corners_[next_[i]]) == 0) {
        return i;
      }
      i = next_[i];
    } while (i != start_);
    return corners_.size();
  }

 private:
  [[nodiscard]] bool ear_at(std::size_t i) const {
    const glm::dvec2& a = corners_[previous_[i]];
    const glm::dvec2& b = corners_[i];
    const glm::dvec2& c = corners_[next_[i]];
    if (orientation(a, b, c) <= 0) {
      return false;
    }
    for (std::size_t j = next_[next_[i]]; j != previous_[i]; j = next_[j]) {
      const glm::dvec2& p = corners_[j];
      if (p != a && p != b && p != c && orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 &&
          orientation(c, a, p) >= 0) {
        return false;
      }
    }
    return true;
  }

  std::span<const glm::dvec2> corners_;
  std::vector<std::size_t> next_;
  std::vector<std::size_t> previous_;
  std::vector<char> is_ear_;
  std::size_t start_ = 0;
};

}  // namespace

int orientation(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const double left = (a.x - c.x) * (b.y - c.y);
  const double right = (a.y - c.y) * (b.x - c.x);
  const double area = left - right;
  // Shewchuk's error bound A: (3 + 16 eps) eps, eps = 2^-53.
  const double bound = 3.3306690738754716e-16 * (std::abs(left) + std::abs(right));
  if (area > bound || -area > bound) {
    return area > 0.0 ? 1 : -1;
  }
  Expansion exact;
  exact.add_product(a.x, b.y);
  exact.add_product(-a.y, b.x);
  exact.add_product(b.x, c.y);
  exact.add_product(-b.y, c.x);
  exact.add_product(c.x, a.y);
  exact.add_product(-c.y, a.x);
  return exact.sign();
}

std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const glm::dvec2> corners) {
  if (corners.size() < 3) {
    throw sim::UserError("a polygon of " + std::to_string(corners.size()) + " corners has no triangles");
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(corners.size() - 2);
  Ring ring(corners);
  while (triangles.size() + 2 < corners.size()) {
    std::size_t ear = ring.best_ear();
    if (ear == corners.size()) {
      ring.find_ears();
      ear = ring.best_ear();
    }
    if (ear == corners.size()) {
      ear = ring.flat_corner();
    }
    if (ear == corners.size()) {
      throw sim::UserError("a polygon of " + std::to_string(corners.size()) +
                           " corners is not simple or not counter-clockwise");
    }
    triangles.push_back({static_cast<std::uint32_t>(ring.previous(ear)), static_cast<std::uint32_t>(ear),
                         static_cast<std::uint32_t>(ring.next(ear))});
    ring.cut(ear);
  }
  return triangles;
}

}  // namespace marti::scenes
