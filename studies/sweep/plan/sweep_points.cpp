#include "studies/sweep/plan/sweep_points.h"

#include <algorithm>
#include <optional>

namespace marti::studies::sweep {

SweepPoints::SweepPoints(const sim::Config& config, const SweepTable& table)
    : config_(config),
      table_(table),
      strides_(table.axes.size(), 1),
      axis_of_key_(config.schema().keys().size(), table.axes.size()) {
  for (std::size_t axis = table.axes.size(); axis-- > 0;) {
    strides_[axis] = size_;
    size_ *= table.axes[axis].steps.size();
  }
  for (std::size_t axis = 0; axis < table.axes.size(); ++axis) {
    named_ = named_ || table.axes[axis].kind == SweepAxis::Kind::named;
    for (const std::size_t key : table.axes[axis].keys) {
      keys_.push_back(key);
      axis_of_key_[key] = axis;
    }
  }
}

std::vector<sim::Setting> SweepPoints::settings(std::uint64_t point) const {
  std::vector<sim::Setting> settings;
  for (std::size_t axis = 0; axis < table_.axes.size(); ++axis) {
    const std::vector<sim::Setting>& step = table_.axes[axis].steps[this->step(point, axis)];
    settings.insert(settings.end(), step.begin(), step.end());
  }
  return settings;
}

std::string SweepPoints::name(std::uint64_t point) const {
  return named_ ? table_.axes.front().names[step(point, 0)] : std::string();
}

sim::Value SweepPoints::value(std::uint64_t point, std::size_t key) const {
  std::span<const sim::Value> values = config_.values_at(key);
  if (const std::size_t axis = axis_of_key_[key]; axis < table_.axes.size()) {
    const std::vector<sim::Setting>& step = table_.axes[axis].steps[this->step(point, axis)];
    const auto found = std::ranges::find(step, key, &sim::Setting::key);
    if (found != step.end()) {
      values = found->values;
    }
  }
  const sim::Key& declared = config_.schema().keys()[key];
  return declared.is_list ? sim::Value(print_values(declared, values)) : values.front();
}

std::vector<sim::Value> SweepPoints::values(std::uint64_t point) const {
  std::vector<sim::Value> values;
  values.reserve(keys_.size() + (named_ ? 1 : 0));
  if (named_) {
    values.emplace_back(name(point));
  }
  for (const std::size_t key : keys_) {
    values.push_back(value(point, key));
  }
  return values;
}

std::string point_text(const sim::Schema& schema, std::span<const std::string> axes,
                       std::span<const sim::Value> values) {
  std::string name;
  std::string settings;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const std::optional<std::size_t> key = schema.find(axes[axis]);
    if (!key) {
      name = '"' + std::get<std::string>(values[axis]) + '"';  // of a named point
      continue;
    }
    const sim::Key& declared = schema.keys()[*key];
    settings +=
        (settings.empty() ? "" : ", ") + declared.name + " = " +
        (declared.is_list ? std::get<std::string>(values[axis]) : print_value(declared.type, values[axis]));
  }
  return name + (name.empty() || settings.empty() ? "" : " with ") + settings;
}

}  // namespace marti::studies::sweep
