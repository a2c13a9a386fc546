// Predicts the steps of one point.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studies/limits/frame_model.h"
#include "studies/limits/reuse_distances.h"
#include "studies/limits/sweep_limits.h"

namespace marti::studies::limits {

class StepPredictor {
 public:
  /// All must outlive the object. `machines` are those of `points`.
  StepPredictor(std::span<const LimitPoint> points,
                std::span<const processors::machine::MachineConfig> machines, const Neighbours& neighbours,
                std::size_t point);

  /// `resource` has a step. The price is left out.
  [[nodiscard]] PredictedStep predict(const helps::Resource& resource) const;

 private:
  struct Guess {
    double end = 0.0;
    LimitBasis basis = LimitBasis::unknown;
    std::string rests_on;
  };

  [[nodiscard]] std::optional<Guess> from_model(const helps::Resource& resource) const;
  [[nodiscard]] std::optional<Guess> from_line(const helps::Resource& resource) const;
  [[nodiscard]] std::vector<CacheMisses> known_misses() const;
  [[nodiscard]] std::optional<Guess> cache_shape(const helps::Resource& resource) const;
  [[nodiscard]] std::optional<Guess> cache_line(const helps::Resource& resource) const;
  [[nodiscard]] std::optional<Guess> smaller_packets(const helps::Resource& resource) const;
  [[nodiscard]] double most_saved(const helps::Resource& resource) const;
  // The nearest point on the axis of the key at `value` or beyond it, seen from this point.
  [[nodiscard]] std::optional<std::size_t> next_on(std::string_view key, double value) const;
  [[nodiscard]] std::string saving(std::size_t neighbour, std::string_view key) const;
  [[nodiscard]] double end_with_misses(const processors::machine::MachineConfig& changed, double misses,
                                       double references) const;
  [[nodiscard]] const PointFigures& figures() const { return points_[point_].figures; }
  [[nodiscard]] const processors::machine::MachineConfig& machine() const { return machines_[point_]; }

  std::span<const LimitPoint> points_;
  std::span<const processors::machine::MachineConfig> machines_;
  const Neighbours& neighbours_;
  std::size_t point_;
  std::optional<FrameModel> model_;
};

}  // namespace marti::studies::limits
