// The frame time of a machine that differs a little from one that was timed. README.md has the model.
#pragma once

#include <optional>
#include <vector>

#include "processors/machine/machine_config.h"
#include "studies/limits/point_figures.h"
#include "studies/limits/queue_model.h"

namespace marti::studies::limits {

/// What all nodes do in a frame; times in ps.
struct FrameWork {
  double computing = 0.0;
  double cache_access = 0.0;
  double delays = 0.0;
  double reads = 0.0;
  double writes = 0.0;
};

/// The pixels of a packet.
[[nodiscard]] double packet_area(const processors::machine::MachineConfig& machine);

class FrameModel {
 public:
  /// The most nodes of a cluster.
  static constexpr double most_customers = 65536.0;

  /// std::nullopt for a frame or a machine that the model does not describe: it describes the image scheme
  /// with one shared memory a cluster, a given tree and one read outstanding a node.
  [[nodiscard]] static std::optional<FrameModel> of(const processors::machine::MachineConfig& machine,
                                                    const PointFigures& figures);

  /// The work of the timed frame on a machine whose clocks and hit cycles are those of `changed`.
  [[nodiscard]] FrameWork work_on(const processors::machine::MachineConfig& changed) const;

  /// The frame time of `changed` with this work, ps. The timed machine with its own work takes the time that
  /// it took.
  [[nodiscard]] double end_of(const processors::machine::MachineConfig& changed, const FrameWork& work) const;

 private:
  // A part of the frame in which a mean number of a cluster's nodes are at work.
  struct Phase {
    double time = 0.0;
    double active = 0.0;
  };
  // Measured sums divided by those that follow from the configuration.
  struct Scales {
    double transfer = 1.0;
    double bank_access = 1.0;
    double interconnect_busy = 1.0;
    double bank_load = 1.0;
  };

  FrameModel(const processors::machine::MachineConfig& machine, const PointFigures& figures);
  [[nodiscard]] QueueModel queues_of(const processors::machine::MachineConfig& machine,
                                     const FrameWork& work) const;
  [[nodiscard]] double cluster_reads(const FrameWork& work) const;
  // Nodes of a cluster that can have work when packets are cut into so many pieces.
  [[nodiscard]] double customers_of(const processors::machine::MachineConfig& machine, double pieces) const;
  void scale();
  void find_phases();
  // Sets the shape of the last phases so that the network reads as much as was counted, if any shape does;
  // returns the reads of a cluster.
  double shape_end(const std::vector<double>& throughputs);
  void find_stretch();

  processors::machine::MachineConfig machine_;
  PointFigures figures_;
  FrameWork work_;
  Scales scales_;
  double busiest_bank_ = 0.0;  // share of the accesses
  double full_time_ = 0.0;     // in which all nodes work
  double end_time_ = 0.0;      // in which fewer do, and their mean number
  double end_active_ = 0.0;
  std::vector<Phase> end_;
  double stretch_ = 1.0;
  double rest_ = 1.0;  // reads that were counted / reads of the network
  std::vector<double> throughputs_;
};

}  // namespace marti::studies::limits
