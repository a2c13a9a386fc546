// What limits the points of a sweep: which step would shorten the frame most, predicted from figures that the
// sweep has anyway. README.md says how.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "studies/helps/resource.h"
#include "studies/keys/price_keys.h"
#include "studies/limits/neighbours.h"
#include "studies/limits/point_figures.h"

namespace marti::studies::limits {

/// A point of a sweep that has been timed.
struct LimitPoint {
  sim::Config config;    ///< of its machine
  PointFigures figures;  ///< of its frame; `end` above 0
  /// The same machine with one node, if it was timed.
  std::optional<PointFigures> one_node{};
};

/// What a prediction rests on.
enum class LimitBasis : std::uint8_t {
  unknown,       ///< there is none
  neighbour,     ///< the sweep has timed the changed machine
  interpolated,  ///< points on both sides of the changed machine
  extended,      ///< points on one side of it, and the model
  bound,         ///< the model; the resource is busy for 90 % of the frame or more
  model          ///< the point's own figures
};

/// One of the resources that can be made better (studies/helps/resources.h).
struct PredictedStep {
  std::string name;  ///< the key that is changed, as in studies/helps
  helps::Part part = helps::Part::nodes;
  std::vector<helps::KeyChange> keys;
  LimitBasis basis = LimitBasis::unknown;
  double saved = 0.0;       ///< share of the frame time; negative: the frame is longer. 0 if unknown
  double most_saved = 1.0;  ///< if unknown: no more than that
  double price = 0.0;       ///< by which the machine's price rises; 0 without prices
  std::string rests_on;     ///< for people: "neighbour: cache.size 16 KiB -> 32 KiB saves 12.3 %"
};

struct PointLimit {
  /// Those worth most first, as in studies/helps; behind them those of which nothing is known.
  std::vector<PredictedStep> steps;
  /// The step to take; null if none of which something is known saves as much as is worth naming.
  [[nodiscard]] const PredictedStep* best() const;
  /// Steps of which nothing is known and that may save more than the one to take.
  [[nodiscard]] std::vector<const PredictedStep*> open() const;
  [[nodiscard]] std::string sentence() const;  ///< for people, without a full stop
};

class SweepLimits {
 public:
  /// `axes` are the keys in which the points differ. Throws UserError for a machine that cannot be read.
  SweepLimits(std::vector<std::string> axes, std::vector<LimitPoint> points,
              std::optional<keys::Prices> prices = std::nullopt);

  /// Two threads may ask at once, but not for one point.
  [[nodiscard]] PointLimit at(std::size_t point) const;

 private:
  [[nodiscard]] static std::vector<const sim::Config*> configs_of(const std::vector<LimitPoint>& points);

  std::vector<LimitPoint> points_;
  std::vector<processors::machine::MachineConfig> machines_;
  Neighbours neighbours_;
  std::optional<keys::Prices> prices_;
};

}  // namespace marti::studies::limits
