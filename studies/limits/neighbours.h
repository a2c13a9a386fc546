// The points of a sweep beside one of them.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config.h"
#include "studies/helps/change.h"

namespace marti::studies::limits {

class Neighbours {
 public:
  /// `axes` are the keys in which points may differ. Of points with equal values the first counts.
  Neighbours(std::vector<std::string> axes, std::span<const sim::Config* const> points);

  /// The point that differs from `point` by these changes; std::nullopt if there is none.
  [[nodiscard]] std::optional<std::size_t> changed(std::size_t point,
                                                   std::span<const helps::KeyChange> changes) const;
  /// The points that differ in the values of `keys` at most, itself among them.
  [[nodiscard]] std::vector<std::size_t> along(std::size_t point,
                                               std::span<const std::string_view> keys) const;
  /// The key's value at a point; std::nullopt if that is not one number or the key is no axis.
  [[nodiscard]] std::optional<double> number(std::size_t point, std::string_view key) const;
  /// As it is written in a TOML file, a text without its quotation marks.
  [[nodiscard]] std::string text(std::size_t point, std::string_view key) const;

 private:
  struct Axis {
    std::string key;
    std::vector<std::string> texts;  // its values, as in a TOML file
    std::vector<std::optional<double>> numbers;
  };
  using Place = std::vector<std::size_t>;  // of a point: indices into `texts`

  [[nodiscard]] std::optional<std::size_t> axis_of(std::string_view key) const;
  [[nodiscard]] std::size_t place_of(Axis& axis, const sim::Config& config) const;

  std::vector<Axis> axes_;
  std::vector<Place> places_;
  std::map<Place, std::size_t> points_;
};

}  // namespace marti::studies::limits
