#include "processors/path/network_course.h"

#include <vector>

#include "memory/routes.h"

namespace marti::processors::path {

namespace {

using memory::NetworkConfig;
using sim::Ticks;

class IdealNetworkCourse final : public NetworkCourse {
 public:
  IdealNetworkCourse(const NetworkConfig& config, PathPieces& pieces, PathKind kind)
      : pieces_(pieces), kind_(kind), hop_(config.clock.cycles(config.hop_cycles)) {}
  PathTip send(const PathTip& sent, std::uint32_t from, std::uint32_t to, std::uint32_t /*bytes*/,
               const PathOwner& owner) override {
    return from == to ? sent : pieces_.append(sent, hop_, owner, kind_);
  }

 private:
  PathPieces& pieces_;
  PathKind kind_;
  Ticks hop_;
};

// `holds_hop` as in memory/network.cpp.
template <class Routes, bool holds_hop>
class RoutedNetworkCourse final : public NetworkCourse {
 public:
  RoutedNetworkCourse(const NetworkConfig& config, std::uint32_t nodes, PathPieces& pieces, PathKind kind)
      : pieces_(pieces),
        kind_(kind),
        hop_(config.clock.cycles(config.hop_cycles)),
        beat_(config.clock.cycles(config.cycles_per_beat)),
        width_(config.width),
        routes_(nodes),
        links_(routes_.table_size()) {}

  PathTip send(const PathTip& sent, std::uint32_t from, std::uint32_t to, std::uint32_t bytes,
               const PathOwner& owner) override {
    if (from == to) {
      return sent;
    }
    const Ticks data = sim::multiply_ticks(beat_, (std::int64_t{bytes} + width_ - 1) / width_);
    const Ticks held = holds_hop ? sim::add_ticks(hop_, data) : data;
    PathTip head = sent;
    routes_.route(from, to, [&](std::size_t link) {
      const PathTip before = later_of(head, links_[link]);
      links_[link] = pieces_.append(before, held, owner, kind_);
      head = pieces_.append(before, hop_, owner, kind_);
    });
    return pieces_.append(head, data, owner, kind_);
  }

 private:
  PathPieces& pieces_;
  PathKind kind_;
  Ticks hop_;
  Ticks beat_;
  std::int64_t width_;
  Routes routes_;
  std::vector<PathTip> links_;  // the message that each link carried last
};

}  // namespace

std::unique_ptr<NetworkCourse> make_network_course(const NetworkConfig& config, std::uint32_t nodes,
                                                   PathPieces& pieces, PathKind kind) {
  using namespace memory;
  switch (config.kind) {
    case NetworkKind::ideal:
      return std::make_unique<IdealNetworkCourse>(config, pieces, kind);
    case NetworkKind::bus:
      return std::make_unique<RoutedNetworkCourse<BusRoutes, true>>(config, nodes, pieces, kind);
    case NetworkKind::crossbar:
      return std::make_unique<RoutedNetworkCourse<CrossbarRoutes, false>>(config, nodes, pieces, kind);
    case NetworkKind::hypercube:
      return std::make_unique<RoutedNetworkCourse<WithHost<HypercubeRoutes>, false>>(config, nodes, pieces,
                                                                                     kind);
    case NetworkKind::mesh:
      break;
  }
  return std::make_unique<RoutedNetworkCourse<WithHost<MeshRoutes>, false>>(config, nodes, pieces, kind);
}

std::uint64_t network_course_bytes(const NetworkConfig& config, std::uint32_t nodes) {
  return memory::network_bytes(config, nodes) / sizeof(Ticks) * sizeof(PathTip);
}

}  // namespace marti::processors::path
