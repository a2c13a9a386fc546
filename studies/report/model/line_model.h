// An analytic model of a frame, fitted to exact points that differ in one axis: the machine as a closed
// network whose demands are read off the points' counters and interpolated between them. docs/report.md has
// the equations.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace marti::studies::report {

/// What the counters of an exact point say; sums over a machine of any number of clusters. Times in ps.
struct PointCounters {
  double x = 0.0;         ///< the point's place on the axis
  double end = 0.0;       ///< frame time, above 0
  double base_end = 0.0;  ///< of the machine that its speed-up is measured against; 0: not known
  double nodes = 1.0;
  double clusters = 1.0;
  double packets = 1.0;    ///< of the frame: no more nodes can have work; 0: not known
  double work = 0.0;       ///< time of all nodes without waits and idling
  double delays = 0.0;     ///< of all nodes for locks, messages and packets
  double reads = 0.0;      ///< of the interconnect
  double links = 1.0;      ///< queues of the interconnect: 1 for a bus, 0 if it has no queue
  double link_busy = 0.0;  ///< of all queues of the interconnect
  double banks = 0.0;      ///< banks that are queues
  double bank_busy = 0.0;  ///< of all banks
};

/// The frame of such a machine by mean value analysis (processors/theory/closed_network.h), ps: `customers`
/// nodes of a cluster go round between computing, links and banks. Without reads there is no queue. Needs
/// work above 0.
[[nodiscard]] double closed_network_end(const PointCounters& counters);

/// A lower bound of the frame: the largest of the work shared by all nodes, the busiest link, the busiest
/// bank; ps.
[[nodiscard]] double asymptotic_end(const PointCounters& counters);

/// The number of nodes of a cluster from which the busiest queue limits; std::nullopt when there is no queue.
[[nodiscard]] std::optional<double> saturation_nodes(const PointCounters& counters);

enum class Zone : std::uint8_t { between, beyond };

struct Modelled {
  double end = 0.0;        ///< ps
  double base_end = 0.0;   ///< ps; 0: not known
  double asymptote = 0.0;  ///< ps, asymptotic_end() of the interpolated counters
  Zone zone = Zone::between;
};

class LineModel {
 public:
  /// `points`: at least two, of different x. `logarithmic`: the axis is interpolated in log x; all x are
  /// above 0 then.
  LineModel(std::vector<PointCounters> points, bool logarithmic);

  /// At the points it is the exact frame time; elsewhere counters are interpolated, and so is the ratio of
  /// exact to closed_network_end(); but never below asymptotic_end(). Beyond the outer points counters go on
  /// as between the last two, and the ratio stays as it is at the last.
  [[nodiscard]] Modelled at(double x) const;

  [[nodiscard]] Zone zone(double x) const;

  [[nodiscard]] std::span<const PointCounters> points() const { return points_; }

 private:
  std::vector<PointCounters> points_;  // ascending by x
  std::vector<double> ratios_;
  bool logarithmic_;
};

/// How far the model is off: |ln(model / exact)| of points that were left out of it.
struct ModelError {
  std::size_t points = 0;
  double mean = 0.0;  ///< as a share: exp of the mean, less 1
  double p95 = 0.0;   ///< the 95th percentile by nearest rank, as a share

  /// Whether a modelled figure may be shown: only with a measured error, and only if that is small enough to
  /// mean anything.
  [[nodiscard]] bool is_known() const { return points > 0 && p95 <= 2.0; }
};

/// Errors of points left out, as gathered over lines.
class LeaveOneOut {
 public:
  /// Leaves every point of the line out once; of lines with fewer than three points nothing can be left out.
  /// An outer point counts only if it is at most two steps beyond the rest, a step being that of the two
  /// beside it: the model is never evaluated farther out.
  void add(const LineModel& line, bool logarithmic);
  /// The error of frame times between other points, or one step of the axis beyond them.
  [[nodiscard]] ModelError of_end(Zone zone) const { return summary(end_[static_cast<std::size_t>(zone)]); }
  [[nodiscard]] ModelError of_speed_up(Zone zone) const {
    return summary(speed_up_[static_cast<std::size_t>(zone)]);
  }

 private:
  [[nodiscard]] static ModelError summary(std::vector<double> errors);

  std::vector<double> end_[2];
  std::vector<double> speed_up_[2];
};

}  // namespace marti::studies::report
