// The points of a sweep by their number: which step of each axis, what it gives, what its keys are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/config.h"
#include "studies/sweep/plan/sweep_table.h"

namespace marti::studies::sweep {

/// Refers to both constructor arguments, which must outlive it.
class SweepPoints {
 public:
  SweepPoints(const sim::Config& config, const SweepTable& table);

  /// Before the filter. Points are numbered from 0, the last axis changing fastest.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// The axes' keys, each once, in the order of the axes.
  [[nodiscard]] const std::vector<std::size_t>& keys() const { return keys_; }
  [[nodiscard]] bool named() const { return named_; }

  [[nodiscard]] std::size_t step(std::uint64_t point, std::size_t axis) const {
    return static_cast<std::size_t>(point / strides_[axis]) % table_.axes[axis].steps.size();
  }
  /// The settings of all axes.
  [[nodiscard]] std::vector<sim::Setting> settings(std::uint64_t point) const;
  /// The name of a named point; empty when there are none.
  [[nodiscard]] std::string name(std::uint64_t point) const;
  /// The value of any key there: what an axis gives it, else what the file does, else the default. A list is
  /// a text.
  [[nodiscard]] sim::Value value(std::uint64_t point, std::size_t key) const;
  /// Of all axes: the name of a named point, and what its keys have.
  [[nodiscard]] std::vector<sim::Value> values(std::uint64_t point) const;

 private:
  const sim::Config& config_;
  const SweepTable& table_;
  std::uint64_t size_ = 1;
  std::vector<std::uint64_t> strides_;  // of each axis
  std::vector<std::size_t> keys_;
  std::vector<std::size_t> axis_of_key_;  // of each key of the schema; table_.axes.size() for none
  bool named_ = false;
};

/// A point of these axes (SweepPlan::axes) for people: "cache.ways = 8, machine.nodes = 2", of a named point
/// "\"small\" with cache.size = \"16 KiB\"".
[[nodiscard]] std::string point_text(const sim::Schema& schema, std::span<const std::string> axes,
                                     std::span<const sim::Value> values);

}  // namespace marti::studies::sweep
