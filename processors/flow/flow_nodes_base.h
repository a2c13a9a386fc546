// The common part of the nodes of all schemes in which rays move between nodes: counters, messages, and the
// path to the cluster's memory.
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "processors/flow/flow_parts.h"
#include "processors/node/cluster_interconnects.h"
#include "processors/walk/cause_observer.h"
#include "processors/walk/log_walker.h"
#include "processors/walk/observer.h"
#include "sim/large_pages.h"

namespace marti::processors::flow {

/// `Derived` has read_done(node, service), called when a read that the node waits for has been served.
template <class Derived>
class FlowNodesBase : public FlowNodes {
 public:
  void connect(std::vector<memory::Interconnect*> interconnects) override {
    interconnects_.connect(std::move(interconnects));
  }
  memory::InterconnectClient& client(std::uint32_t cluster) override { return clients_[cluster]; }
  sim::Ticks end() const override { return std::max(end_, host_.last_arrival()); }
  std::vector<cost::NodeStatistics> statistics() const override {
    return {statistics_.begin(), statistics_.end()};
  }
  void report(FlowResult& result) const override {
    result.nodes.assign(counts_.begin(), counts_.end());
    for (FlowCounts& node : result.nodes) {
      node.bytes_sent = node.passed_on * input_.config.messages.ray_bytes +
                        node.contributions * input_.config.messages.contribution_bytes;
    }
  }

 protected:
  explicit FlowNodesBase(const FlowParts& parts)
      : input_(parts.input),
        engine_(parts.engine),
        host_(parts.host),
        networks_(parts.networks),
        statistics_(parts.input.config.all_nodes()),
        counts_(parts.input.config.all_nodes()),
        tallies_(parts.input.config.all_nodes()),
        watched_(parts.input.observer == nullptr ? 0 : parts.input.config.all_nodes()) {
    clients_.reserve(input_.config.clusters);
    for (std::uint32_t cluster = 0; cluster < input_.config.clusters; ++cluster) {
      clients_.emplace_back(static_cast<Derived&>(*this), cluster * input_.config.nodes);
    }
  }

  // The numbers of all clusters, in an order drawn from `seed` (0: ascending).
  [[nodiscard]] std::vector<std::uint32_t> first_order(std::uint64_t seed) const {
    return node::order_drawn_from(seed, input_.config.clusters);
  }

  std::uint32_t cluster_of(std::uint32_t node) const {
    return networks_.size() == 1 ? 0 : node / input_.config.nodes;
  }
  std::uint32_t port_of(std::uint32_t node) const { return node - cluster_of(node) * input_.config.nodes; }
  memory::Interconnect& interconnect_of(std::uint32_t node) { return interconnects_[cluster_of(node)]; }
  void read_memory(std::uint32_t node, memory::Address address, std::uint32_t bytes) {
    const std::uint32_t cluster = cluster_of(node);
    interconnects_.read(cluster, clients_[cluster], {port_of(node), address, bytes});
  }
  void reply(std::uint32_t node) {
    const std::uint32_t cluster = cluster_of(node);
    interconnects_.reply(cluster, clients_[cluster], port_of(node));
  }
  void post(FlowEvent event, sim::Ticks time, std::uint32_t component) {
    engine_.post(sim::Event::make(time, static_cast<std::uint8_t>(event), component));
  }
  void spend(std::uint32_t node, cost::Activity activity, sim::Ticks time) {
    sim::Ticks& sum = statistics_[node].time[static_cast<std::size_t>(activity)];
    sum = sim::add_ticks(sum, time);
  }
  void spend(std::uint32_t node, const memory::Service& service) {
    cost::add_service(statistics_[node].time, service);
  }

  // Tells the observer, if there is one, that the node was in `state` from the last time told until `to`.
  void watch(std::uint32_t node, walk::NodeState state, sim::Ticks to, walk::PixelPlace place = {}) {
    if (input_.observer != nullptr && watched_[node].until != to) {
      input_.observer->spent(node, state, watched_[node].until, to, place);
      watched_[node].until = to;
    }
  }
  // Tells the observer of a read that the node has waited for since the last time told.
  void watch_read(std::uint32_t node, const memory::Service& service, walk::PixelPlace place) {
    if (input_.observer != nullptr) {
      walk::spent_reading(*input_.observer, node, service, watched_[node].until, place);
      watched_[node].until = service.done;
    }
  }
  // Tells the observer of work for a ray since the last time told, and of the misses in it. `word`: the ray's
  // first step that is not taken yet.
  void watch_work(std::uint32_t node, sim::Ticks to, walk::PixelPlace place, const std::uint32_t* word) {
    if (input_.causes != nullptr) {
      const std::span<const std::uint32_t> words = input_.log.pixel(place.x, place.y);
      input_.causes->worked(
          node, statistics_[node],
          {place.y * input_.log.width + place.x, static_cast<std::uint32_t>(word - words.data())});
    }
    watch(node, walk::NodeState::working, to, place);
    if (input_.observer != nullptr) {
      const std::int64_t all = statistics_[node].references.all_misses();
      if (const std::int64_t more = all - std::exchange(watched_[node].misses, all); more != 0) {
        input_.observer->missed(node, more, place);
      }
    }
  }

  // Sends ray number `ray` to another node; returns its time of arrival. `aside`: it was set aside.
  sim::Ticks send_ray(std::uint32_t from, std::uint32_t to, std::uint32_t ray, sim::Ticks now,
                      bool aside = false) {
    const std::uint32_t bytes = input_.config.messages.ray_bytes;
    ++counts_[from].passed_on;
    const sim::Ticks arrival =
        networks_[cluster_of(from)]->send(now, port_of(from), port_of(to), bytes).arrival;
    if (input_.causes != nullptr) [[unlikely]] {
      input_.causes->sent({ray, from, to, bytes, aside, now, arrival});
    }
    return arrival;
  }
  // Sends the host what a ray adds to its pixel.
  void send_contribution(std::uint32_t from, sim::Ticks now) {
    const std::uint32_t bytes = input_.config.messages.contribution_bytes;
    ++counts_[from].contributions;
    const sim::Ticks arrival =
        networks_[cluster_of(from)]->send(now, port_of(from), input_.config.nodes, bytes).arrival;
    if (input_.causes != nullptr) [[unlikely]] {
      input_.causes->sent({walk::RayMessage::none, from, 0, bytes, false, now, arrival});
    }
    host_.collect(arrival);
  }
  // As send_ray(), for a camera ray.
  sim::Ticks send_camera_ray(std::uint32_t to, std::uint32_t ray, sim::Ticks now, bool aside = false) {
    const std::uint32_t bytes = input_.config.messages.ray_bytes;
    const sim::Ticks arrival =
        networks_[cluster_of(to)]->send(now, input_.config.nodes, port_of(to), bytes).arrival;
    if (input_.causes != nullptr) [[unlikely]] {
      input_.causes->sent({ray, host_link(cluster_of(to)), to, bytes, aside, now, arrival});
    }
    return arrival;
  }
  // The host as a sender of rays to a cluster, for who asks for causes.
  std::uint32_t host_link(std::uint32_t cluster) const { return input_.config.all_nodes() + cluster; }

  // Completes the node's time: adds what follows from counts, and the idle time after its `finish`.
  template <class Walker>
  void finish_node(std::uint32_t node, const Walker& walker) {
    cost::NodeStatistics& statistics = statistics_[node];
    walker.flush(tallies_[node], statistics);
    cost::add_counted_time(walker.ticks(), statistics.steps, statistics.references.all_hits(),
                           statistics.time);
    statistics.time[static_cast<std::size_t>(cost::Activity::idle)] = end() - statistics.finish;
    watch(node, walk::NodeState::idle, end());
  }

  walk::ReplayInput input_;
  sim::Engine& engine_;
  FlowHost& host_;
  std::vector<memory::Network*> networks_;
  sim::LargeVector<cost::NodeStatistics> statistics_;
  sim::LargeVector<FlowCounts> counts_;
  sim::LargeVector<walk::VisitTally> tallies_;  // planned visits that are not in the statistics yet
  sim::Ticks end_ = 0;                          // of the nodes' work so far

 private:
  // One cluster's ports, with port numbers turned into node numbers. Pixels are kept by the host, so there
  // are no writes to memory.
  class Client final : public memory::InterconnectClient {
   public:
    Client(Derived& nodes, std::uint32_t first) : nodes_(nodes), first_(first) {}
    void read_done(std::uint32_t port, const memory::Service& service) override {
      nodes_.read_done(first_ + port, service);
    }
    void write_done(std::uint32_t /*port*/, sim::Ticks /*done*/) override {}

   private:
    Derived& nodes_;
    std::uint32_t first_;
  };

  // How far the observer has been told of a node.
  struct Watched {
    sim::Ticks until = 0;
    std::int64_t misses = 0;
  };

  std::vector<Watched> watched_;  // empty without an observer
  std::vector<Client> clients_;
  node::ClusterInterconnects interconnects_;
};

}  // namespace marti::processors::flow
