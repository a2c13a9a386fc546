#include "studies/limits/neighbours.h"

#include <algorithm>
#include <utility>

#include "sim/error.h"
#include "studies/keys/setting_value.h"

namespace marti::studies::limits {

Neighbours::Neighbours(std::vector<std::string> axes, std::span<const sim::Config* const> points) {
  for (std::string& key : axes) {
    axes_.push_back({std::move(key), {}, {}});
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    Place place;
    for (Axis& axis : axes_) {
      place.push_back(place_of(axis, *points[i]));
    }
    points_.try_emplace(place, i);
    places_.push_back(std::move(place));
  }
}

std::size_t Neighbours::place_of(Axis& axis, const sim::Config& config) const {
  const std::optional<std::size_t> index = config.schema().find(axis.key);
  sim::ensure(index.has_value(), "an axis is not declared");
  const std::span<const sim::Value> values = config.values_at(*index);
  std::string text = sim::print_values(config.schema().keys()[*index], values);
  const auto found = std::ranges::find(axis.texts, text);
  const auto place = static_cast<std::size_t>(found - axis.texts.begin());
  if (found == axis.texts.end()) {
    axis.texts.push_back(std::move(text));
    axis.numbers.push_back(values.size() == 1 ? sim::number_of(values[0]) : std::nullopt);
  }
  return place;
}

std::optional<std::size_t> Neighbours::axis_of(std::string_view key) const {
  const auto found = std::ranges::find(axes_, key, &Axis::key);
  return found == axes_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - axes_.begin()));
}

std::optional<std::size_t> Neighbours::changed(std::size_t point,
                                               std::span<const helps::KeyChange> changes) const {
  Place place = places_[point];
  for (const helps::KeyChange& change : changes) {
    const std::optional<std::size_t> axis = axis_of(change.key);
    if (!axis) {
      return std::nullopt;
    }
    const std::vector<std::string>& texts = axes_[*axis].texts;
    place[*axis] = static_cast<std::size_t>(std::ranges::find(texts, change.to) - texts.begin());
  }
  const auto found = points_.find(place);
  return found == points_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::size_t> Neighbours::along(std::size_t point, std::span<const std::string_view> keys) const {
  std::vector<Place> wanted = {places_[point]};
  for (const std::string_view key : keys) {
    if (const std::optional<std::size_t> axis = axis_of(key)) {
      std::vector<Place> more;
      for (const Place& place : wanted) {
        for (std::size_t value = 0; value < axes_[*axis].texts.size(); ++value) {
          more.push_back(place);
          more.back()[*axis] = value;
        }
      }
      wanted = std::move(more);
    }
  }
  std::vector<std::size_t> found;
  for (const Place& place : wanted) {
    if (const auto at = points_.find(place); at != points_.end()) {
      found.push_back(at->second);
    }
  }
  return found;
}

std::optional<double> Neighbours::number(std::size_t point, std::string_view key) const {
  const std::optional<std::size_t> axis = axis_of(key);
  return axis ? axes_[*axis].numbers[places_[point][*axis]] : std::nullopt;
}

std::string Neighbours::text(std::size_t point, std::string_view key) const {
  const std::optional<std::size_t> axis = axis_of(key);
  return axis ? keys::plain_setting(axes_[*axis].texts[places_[point][*axis]]) : std::string();
}

}  // namespace marti::studies::limits
