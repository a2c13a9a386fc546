// A second model of the space scheme, for comparison: plain structures, an event for everything, no running
// ahead, no pools. It shares with the first one only the log's reader, step costs, the layout, the regions
// and the network.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "memory/network.h"
#include "processors/flow/space/space_plan.h"
#include "processors/program/ray_tree.h"
#include "processors/replay/replay.h"
#include "processors/replay/space.h"
#include "tests/support/logged_samples.h"
#include "tests/support/naive_caches.h"
#include "tests/support/naive_counts.h"
#include "tests/support/naive_flow_path.h"
#include "tests/support/naive_program.h"

namespace marti::test {

class NaiveSpace {
 public:
  /// Caches of random replacement draw from a stream for each node and are not for this model.
  /// `counts`, where given, is told of every reference.
  NaiveSpace(const processors::program::WorkLog& log, const processors::machine::MachineConfig& machine,
             NaiveCounts* counts = nullptr)
      : log_(log),
        machine_(machine),
        program_(log, machine),
        plan_(processors::flow::plan_space(log, machine, program_.layout())),
        packets_(log.width, log.height, machine.packets),
        counted_(counts),
        nodes_(machine.all_nodes()),
        clusters_(machine.clusters) {
    for (Node& node : nodes_) {
      node.caches.emplace(machine);
    }
    for (Cluster& cluster : clusters_) {
      cluster.network = memory::make_network(machine.network, machine.nodes);
      cluster.ready_at = machine.host.clock.cycles(machine.host.latency_cycles);
    }
  }

  NaiveFlowPath path;

  processors::replay::MachineResult run() {
    for (std::uint32_t c = 0; c < machine_.clusters; ++c) {
      post(clusters_[c].ready_at, admit_class, c, {});
    }
    while (!events_.empty()) {
      const auto [time, event_class, component, sequence, ray] = *events_.begin();
      events_.erase(events_.begin());
      switch (event_class) {
        case arrive_class:
          nodes_[component].queue.push_back({time, ray});
          if (nodes_[component].idle) {
            post(time, look_class, component, {});
          }
          break;
        case done_class:
          done(component, time);
          break;
        case look_class:
          if (nodes_[component].idle) {
            look(component, time);
          }
          break;
        default:
          admit(component, time);
      }
    }
    return result();
  }

 private:
  enum : int { arrive_class, done_class, look_class, admit_class };

  struct Ray {
    std::shared_ptr<std::vector<processors::program::LoggedRay>> tree;
    std::uint32_t number = 0;
    const std::uint32_t* word = nullptr;
    std::uint32_t sender = 0;  // or who has freed a slot for it
    NaivePiece message{};
    [[nodiscard]] const processors::program::LoggedRay& logged() const { return (*tree)[number]; }
    [[nodiscard]] bool over() const { return word == logged().end; }
    [[nodiscard]] bool contributes() const {
      bool lit = logged().kind != processors::program::RayKind::shadow || number == 0;
      for (const std::uint32_t* w = logged().begin; w != logged().end;
           w += processors::program::step_words(w)) {
        lit = lit || processors::program::step_of(*w) == processors::program::Step::light;
      }
      return lit;
    }
  };
  using RayPointer = std::shared_ptr<Ray>;
  struct Queued {
    sim::Ticks arrival;
    RayPointer ray;
  };
  struct Waiting {
    std::optional<std::uint32_t> from;  // std::nullopt: the host
    RayPointer ray;
    sim::Ticks since = 0;
  };
  struct Node {
    std::deque<Queued> queue;
    std::deque<Waiting> waiting;
    std::vector<RayPointer> made;
    RayPointer current;
    bool idle = true;
    std::int64_t slots = 0;
    std::int64_t set_aside = 0;
    sim::Ticks free_at = 0;
    std::optional<NaiveCaches> caches;
    processors::cost::NodeStatistics statistics;
    processors::flow::FlowCounts counts;
  };
  struct Cluster {
    std::unique_ptr<memory::Network> network;
    sim::Ticks ready_at = 0;
    bool began = false;  // has sent a ray
    std::int64_t in_flight = 0;
    std::deque<std::span<const std::uint32_t>> samples;  // of the packet it has drawn
  };

  void post(sim::Ticks time, int event_class, std::uint32_t component, RayPointer ray) {
    events_.insert({time, event_class, component, sequence_++, std::move(ray)});
  }
  std::uint32_t base(std::uint32_t node) const { return node / machine_.nodes * machine_.nodes; }
  Cluster& cluster_of(std::uint32_t node) { return clusters_[node / machine_.nodes]; }
  std::uint32_t host_of(std::uint32_t node) const { return machine_.all_nodes() + node / machine_.nodes; }

  std::optional<std::uint32_t> owner(const std::uint32_t* word) const {
    using processors::program::Step;
    const Step step = processors::program::step_of(*word);
    if (step != Step::branch && step != Step::leaf && step != Step::partial_leaf &&
        step != Step::mailed_leaf && step != Step::cut) {
      return std::nullopt;
    }
    const std::uint32_t region = plan_.regions.region_of[processors::program::operand_of(*word)];
    if (region == processors::flow::RegionMap::top) {
      return std::nullopt;
    }
    return plan_.node_of_region[region];
  }

  // --- host ---

  bool draw(Cluster& cluster) {
    while (cluster.samples.empty() && next_packet_ < packets_.size()) {
      const processors::machine::Packet packet = packets_[next_packet_++];
      for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
        for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
          for (const auto& words : samples_of_pixel(log_, x, y)) {
            cluster.samples.push_back(words);
          }
        }
      }
    }
    return !cluster.samples.empty();
  }

  void admit(std::uint32_t number, sim::Ticks now) {
    Cluster& cluster = clusters_[number];
    while (cluster.in_flight < processors::replay::admission_limit(machine_) && draw(cluster)) {
      if (cluster.ready_at > now) {
        post(cluster.ready_at, admit_class, number, {});
        return;
      }
      const std::span<const std::uint32_t> words = cluster.samples.front();
      cluster.samples.pop_front();
      const sim::Ticks occupancy = machine_.host.clock.cycles(machine_.host.occupancy_cycles);
      const sim::Ticks was_ready = cluster.ready_at;
      cluster.ready_at = now + occupancy;
      host_busy_ += occupancy;
      const auto ray = std::make_shared<Ray>();
      ray->tree = std::make_shared<std::vector<processors::program::LoggedRay>>();
      processors::program::rays_of_sample(words, *ray->tree);
      ray->word = ray->logged().begin;
      std::optional<std::uint32_t> to;
      for (const std::uint32_t* w = ray->word; w != ray->logged().end && !to;
           w += processors::program::step_words(w)) {
        to = owner(w);
      }
      enter(cluster);
      const std::uint32_t target = number * machine_.nodes + to.value_or(sent_ % machine_.nodes);
      if (!std::exchange(cluster.began, true)) {
        path.worked(host_of(target), {0, was_ready, target, processors::path::PathKind::dispatch});
      }
      path.worked(host_of(target), {now, cluster.ready_at, target, processors::path::PathKind::dispatch});
      offer(std::nullopt, target, ray, now);
      ++sent_;
    }
  }

  void enter(Cluster& cluster) {
    ++cluster.in_flight;
    std::int64_t all = 0;
    for (const Cluster& each : clusters_) {
      all += each.in_flight;
    }
    most_in_flight_ = std::max(most_in_flight_, all);
  }

  // --- messages ---

  void offer(std::optional<std::uint32_t> from, std::uint32_t to, const RayPointer& ray, sim::Ticks now) {
    if (nodes_[to].slots < machine_.space.queue) {
      ray->sender = from.value_or(host_of(to));
      send(from, to, ray, now);
      return;
    }
    nodes_[to].waiting.push_back({from, ray, now});
    if (from) {
      Node& sender = nodes_[*from];
      sender.counts.most_set_aside = std::max(sender.counts.most_set_aside, ++sender.set_aside);
    }
  }

  void send(std::optional<std::uint32_t> from, std::uint32_t to, const RayPointer& ray, sim::Ticks now) {
    Node& receiver = nodes_[to];
    receiver.counts.longest_queue = std::max(receiver.counts.longest_queue, ++receiver.slots);
    const std::uint32_t bytes = machine_.messages.ray_bytes;
    std::uint32_t port = machine_.nodes;
    if (from) {
      port = *from - base(*from);
      ++nodes_[*from].counts.passed_on;
      nodes_[*from].counts.bytes_sent += bytes;
    }
    const sim::Ticks arrival = cluster_of(to).network->send(now, port, to - base(to), bytes).arrival;
    ray->message = {now, arrival, from.value_or(to), processors::path::PathKind::network};
    post(arrival, arrive_class, to, ray);
  }

  // --- nodes ---

  void look(std::uint32_t number, sim::Ticks now) {
    Node& node = nodes_[number];
    time_of(node, processors::cost::Activity::message_wait) += now - node.free_at;
    node.free_at = now;
    sim::Ticks time = now;
    if (!node.made.empty()) {
      node.current = node.made.back();
      node.made.pop_back();
    } else if (!node.queue.empty()) {
      node.current = node.queue.front().ray;
      node.counts.queued += now - node.queue.front().arrival;
      path.took(number, node.current->sender, node.current->message);
      node.queue.pop_front();
      --node.slots;
      ++node.counts.taken;
      node.idle = false;
      const sim::Ticks receive = machine_.clock.cycles(machine_.messages.receive_cycles);
      time_of(node, processors::cost::Activity::messaging) += receive;
      time += receive;
      if (!node.waiting.empty()) {
        const Waiting waited = node.waiting.front();
        node.waiting.pop_front();
        if (waited.from) {
          --nodes_[*waited.from].set_aside;
        }
        waited.ray->sender = waited.since < now ? number : waited.from.value_or(host_of(number));
        send(waited.from, number, waited.ray, now);
      }
    } else {
      node.idle = true;
      return;
    }
    node.idle = false;
    Ray& ray = *node.current;
    const std::uint32_t port = number - base(number);
    while (!ray.over() && owner(ray.word).value_or(port) == port) {
      time += take_step(node, ray, ray.word);
      ray.word += processors::program::step_words(ray.word);
    }
    if (!ray.over() || ray.contributes()) {
      const sim::Ticks send = machine_.clock.cycles(machine_.messages.send_cycles);
      time_of(node, processors::cost::Activity::messaging) += send;
      time += send;
    }
    post(time, done_class, number, {});
    path.worked(number, {now, time, number});
  }

  void done(std::uint32_t number, sim::Ticks now) {
    Node& node = nodes_[number];
    const RayPointer ray = std::move(node.current);
    node.statistics.finish = now;
    path.finished(number, now);
    node.free_at = now;
    if (!ray->over()) {
      offer(number, base(number) + owner(ray->word).value(), ray, now);
    } else {
      Cluster& cluster = cluster_of(number);
      ++node.counts.ended;
      if (ray->contributes()) {
        const std::uint32_t bytes = machine_.messages.contribution_bytes;
        ++node.counts.contributions;
        node.counts.bytes_sent += bytes;
        const sim::Ticks arrival =
            cluster.network->send(now, number - base(number), machine_.nodes, bytes).arrival;
        path.contributed(number, now, arrival);
        last_arrival_ = std::max(last_arrival_, arrival);
      }
      --cluster.in_flight;
      std::vector<RayPointer> children;
      for (std::uint32_t child = ray->logged().first_child; child != processors::program::LoggedRay::none;
           child = (*ray->tree)[child].next_sibling) {
        children.push_back(std::make_shared<Ray>(Ray{ray->tree, child, (*ray->tree)[child].begin}));
        enter(cluster);
        ++node.counts.made;
      }
      node.made.insert(node.made.end(), children.rbegin(), children.rend());
      if (cluster.in_flight < processors::replay::admission_limit(machine_)) {
        path.let_go(host_of(number), number, now);
      }
      post(now, admit_class, number / machine_.nodes, {});
    }
    look(number, now);
  }

  static sim::Ticks& time_of(Node& node, processors::cost::Activity activity) {
    return node.statistics.time[static_cast<std::size_t>(activity)];
  }

  // --- steps ---

  sim::Ticks local(Node& node, std::uint64_t bytes) const {
    const sim::Ticks access = machine_.local.clock.cycles(machine_.local.access_cycles);
    const std::uint64_t beats = (bytes + machine_.local.width - 1) / machine_.local.width;
    const sim::Ticks transfer =
        machine_.local.clock.cycles(machine_.local.cycles_per_beat) * static_cast<sim::Ticks>(beats);
    time_of(node, processors::cost::Activity::bank_access) += access;
    time_of(node, processors::cost::Activity::transfer) += transfer;
    return access + transfer;
  }

  sim::Ticks refer(Node& node, const NaiveAction& action) const {
    const auto k = static_cast<std::size_t>(action.kind);
    if (node.caches->refer(action.kind, action.address)) {
      ++node.statistics.references.hits[k];
      count(node, action, true);
      time_of(node, processors::cost::Activity::cache_access) += program_.ticks().hit;
      return program_.ticks().hit;
    }
    ++node.statistics.references.misses[k];
    count(node, action, false);
    const sim::Ticks time = local(node, node.caches->present() ? machine_.cache.cache.line : action.bytes);
    if (counted_ != nullptr) {
      counted_->wait(action, time);
    }
    return time;
  }
  void count(const Node& node, const NaiveAction& action, bool hit) const {
    if (counted_ != nullptr) {
      counted_->refer(static_cast<std::uint32_t>(&node - nodes_.data()), node.caches->number_of(action.kind),
                      action, action.address / program_.unit(), hit);
    }
  }

  sim::Ticks take_step(Node& node, const Ray& ray, const std::uint32_t* word) const {
    count_step(log_, word, node.statistics.steps);
    sim::Ticks time = 0;
    for (const NaiveAction& action : program_.actions_of(word, ray.logged().operand())) {
      if (action.what == NaiveAction::What::refer) {
        time += refer(node, action);
      } else {
        time_of(node, action.activity) += action.time;
        time += action.time;
      }
    }
    return time;
  }

  processors::replay::MachineResult result() {
    processors::replay::MachineResult result;
    result.end = last_arrival_;
    for (const Node& node : nodes_) {
      result.end = std::max(result.end, node.statistics.finish);
    }
    for (Node& node : nodes_) {
      time_of(node, processors::cost::Activity::idle) = result.end - node.statistics.finish;
      result.nodes.push_back(node.statistics);
      result.flow.nodes.push_back(node.counts);
      result.flow.collected += node.counts.contributions;
      result.flow.rays += node.counts.made;
    }
    for (const Cluster& cluster : clusters_) {
      result.flow.networks.push_back(cluster.network->statistics());
      result.flow.memory_bytes.insert(result.flow.memory_bytes.end(), plan_.memory_bytes.begin(),
                                      plan_.memory_bytes.end());
    }
    result.host.requests = static_cast<std::int64_t>(sent_);
    result.host.busy = host_busy_;
    result.flow.rays += result.host.requests;
    result.flow.most_in_flight = most_in_flight_;
    result.flow.regions = plan_.regions.size();
    result.flow.top_nodes = plan_.regions.top_nodes;
    result.flow.duplicated_primitives = plan_.duplicated_primitives;
    result.flow.sampling_work = plan_.sampling_work;
    return result;
  }

  const processors::program::WorkLog& log_;
  const processors::machine::MachineConfig& machine_;
  NaiveProgram program_;
  processors::flow::SpacePlan plan_;
  processors::machine::PacketList packets_;
  NaiveCounts* counted_;
  std::vector<Node> nodes_;
  std::vector<Cluster> clusters_;
  std::set<std::tuple<sim::Ticks, int, std::uint32_t, std::uint64_t, RayPointer>> events_;
  std::uint64_t sequence_ = 0;
  std::uint64_t next_packet_ = 0;
  std::uint64_t sent_ = 0;
  sim::Ticks host_busy_ = 0;
  std::int64_t most_in_flight_ = 0;
  sim::Ticks last_arrival_ = 0;
};

}  // namespace marti::test
