#include "processors/path/ray_courses.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::processors::path {

RayCourses::RayCourses(const machine::MachineConfig& config, PathPieces& pieces)
    : pieces_(pieces),
      nodes_(config.all_nodes()),
      nodes_of_cluster_(config.nodes),
      latency_(config.host.clock.cycles(config.host.latency_cycles)),
      occupancy_(config.host.clock.cycles(config.host.occupancy_cycles)) {
  pieces_.take(config.clusters * (sizeof(Host) + network_course_bytes(config.network, config.nodes)));
  hosts_.resize(config.clusters);
  for (std::uint32_t cluster = 0; cluster < config.clusters; ++cluster) {
    networks_.push_back(make_network_course(config.network, config.nodes, pieces, PathKind::network));
  }
}

PathTip& RayCourses::ray(std::uint32_t number) {
  if (number >= rays_.size()) {
    const std::size_t more = std::max<std::size_t>(number + 1, 2 * rays_.size()) - rays_.size();
    pieces_.take(more * sizeof(PathTip));
    rays_.resize(rays_.size() + more);
  }
  return rays_[number];
}

PathTip RayCourses::send(const PathTip& sent, const walk::RayMessage& message) {
  const bool from_host = is_host(message.sender);
  const bool to_host = message.ray == walk::RayMessage::none;
  const PathOwner owner = {from_host ? message.to : message.sender, {}};
  const std::uint32_t cluster = owner.node / nodes_of_cluster_;
  const auto port_of = [&](std::uint32_t node) { return node - cluster * nodes_of_cluster_; };
  PathTip arrived =
      networks_[cluster]->send(sent, from_host ? nodes_of_cluster_ : port_of(message.sender),
                               to_host ? nodes_of_cluster_ : port_of(message.to), message.bytes, owner);
  sim::ensure(sent.end() == message.sent && arrived.end() == message.arrival,
              "a message has not arrived at the end of its recorded course");
  if (to_host && arrived.end() > last_contribution_.end()) {
    last_contribution_ = arrived;
  }
  return arrived;
}

void RayCourses::let_go(std::uint32_t sender, const PathTip& freed, sim::Ticks now) {
  PathTip& kept = hosts_[sender - nodes_].let_go;
  if (kept.end() != now) {
    kept = freed;
  }
}

void RayCourses::send_camera_ray(std::uint32_t cluster, std::uint32_t to, sim::Ticks now) {
  Host& host = hosts_[cluster];
  if (!host.ready) {
    host.ready = pieces_.append({}, latency_, {to, {}}, PathKind::dispatch);
  }
  host.sending = host.ready->end() == now ? *host.ready : host.let_go;
  sim::ensure(host.sending.end() == now, "the host sends a camera ray for no known cause");
  host.ready = pieces_.append(host.sending, occupancy_, {to, {}}, PathKind::dispatch);
}

}  // namespace marti::processors::path
