// The chains of rays on their way between nodes, and of the host that sends camera rays.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/path/network_course.h"
#include "processors/path/path_pieces.h"
#include "processors/walk/cause_observer.h"

namespace marti::processors::path {

class RayCourses {
 public:
  /// The pieces must outlive it.
  RayCourses(const machine::MachineConfig& config, PathPieces& pieces);

  /// The chain of a ray that is under way, in a queue or set aside.
  PathTip& ray(std::uint32_t number);
  /// The chain with the message's way through its network. A contribution's is kept if it ends last.
  PathTip send(const PathTip& sent, const walk::RayMessage& message);
  /// The chain of the contribution that arrives last, the first of those that arrive at the same time.
  [[nodiscard]] const PathTip& last_contribution() const { return last_contribution_; }

  [[nodiscard]] bool is_host(std::uint32_t sender) const { return sender >= nodes_; }
  /// A credit or slot for which the host waited has become free with `freed`, which ends at `now`.
  void let_go(std::uint32_t sender, const PathTip& freed, sim::Ticks now);
  /// The host sends a camera ray at `now`: when it could after the one before, or when it was let go.
  void send_camera_ray(std::uint32_t cluster, std::uint32_t to, sim::Ticks now);
  /// The host's chain up to where it sent its last camera ray into the cluster.
  [[nodiscard]] const PathTip& sending(std::uint32_t sender) const { return hosts_[sender - nodes_].sending; }

 private:
  struct Host {
    std::optional<PathTip> ready;  // up to when it can send again; empty: it has sent nothing yet
    PathTip let_go;                // the first chain that let it go at the last time at which one did
    PathTip sending;
  };

  PathPieces& pieces_;
  std::uint32_t nodes_;
  std::uint32_t nodes_of_cluster_;
  sim::Ticks latency_;
  sim::Ticks occupancy_;
  std::vector<std::unique_ptr<NetworkCourse>> networks_;
  std::vector<Host> hosts_;
  std::vector<PathTip> rays_;  // by their numbers
  PathTip last_contribution_;
};

}  // namespace marti::processors::path
