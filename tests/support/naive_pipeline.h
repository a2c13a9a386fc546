// A second pipeline, written from docs/internals/pipeline.md with plain structures: one cluster, a copy of
// the database in each node's own memory, one level of caches or none. It goes through a ray's steps one by
// one and keeps events in a set.
#pragma once

#include <deque>
#include <list>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "memory/network.h"
#include "processors/flow/flow_result.h"
#include "processors/flow/pipeline/stages.h"
#include "processors/machine/packets.h"
#include "processors/program/ray_tree.h"
#include "tests/support/logged_samples.h"
#include "tests/support/naive_caches.h"
#include "tests/support/naive_counts.h"
#include "tests/support/naive_flow_path.h"
#include "tests/support/naive_program.h"

namespace marti::test {

class NaivePipeline {
 public:
  struct Node {
    processors::flow::FlowCounts counts;
    sim::Ticks served = 0;  ///< steps of rays
    sim::Ticks message_wait = 0;
    sim::Ticks queue_full_wait = 0;
    sim::Ticks messaging = 0;
    sim::Ticks finish = 0;
  };

  /// `counts`, where given, is told of every reference.
  NaivePipeline(const processors::program::WorkLog& log, const processors::machine::MachineConfig& machine,
                NaiveCounts* counts = nullptr)
      : log_(log),
        machine_(machine),
        program_(log, machine),
        counted_(counts),
        network_(memory::make_network(machine.network, machine.nodes)),
        send_(machine.clock.cycles(machine.messages.send_cycles)),
        receive_(machine.clock.cycles(machine.messages.receive_cycles)),
        host_ready_(machine.host.clock.cycles(machine.host.latency_cycles)),
        waiting_(3) {
    limit_ = machine.pipeline.in_flight != 0 ? machine.pipeline.in_flight
                                             : processors::machine::most_in_flight(machine.pipeline);
    for (const auto& [stage, count] : {std::pair{processors::flow::Stage::search, machine.pipeline.search},
                                       std::pair{processors::flow::Stage::nearest, machine.pipeline.nearest},
                                       std::pair{processors::flow::Stage::shade, machine.pipeline.shade}}) {
      for (std::uint32_t i = 0; i < count; ++i) {
        states_.emplace_back(machine).stage = stage;
        nodes.emplace_back();
      }
    }
    const processors::machine::PacketList packets(log.width, log.height, machine.packets);
    for (std::uint64_t number = 0; number < packets.size(); ++number) {
      const processors::machine::Packet packet = packets[number];
      for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
        for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
          for (const auto& words : samples_of_pixel(log, x, y)) {
            auto tree = std::make_shared<Tree>();
            processors::program::rays_of_sample(words, *tree);
            cameras_.push_back(ray_of(tree, 0));
          }
        }
      }
    }
    run();
  }

  std::vector<Node> nodes;
  NaiveFlowPath path;
  sim::Ticks end = 0;
  std::uint32_t most_in_flight_seen = 0;
  [[nodiscard]] const memory::NetworkStatistics& network() const { return network_->statistics(); }

 private:
  using Tree = std::vector<processors::program::LoggedRay>;
  using Stage = processors::flow::Stage;
  enum Class : int { done, wake, admit };
  enum class Doing { nothing, contributing, ending, sending, blocked, granted };

  struct Ray {
    std::shared_ptr<Tree> tree;
    std::uint32_t number = 0;
    const std::uint32_t* word = nullptr;
    sim::Ticks arrival = 0;
    std::uint32_t sender = 0;
    NaivePiece message{};
    bool record_read = false;
    bool lit = false;
    [[nodiscard]] const processors::program::LoggedRay& logged() const { return (*tree)[number]; }
  };
  struct State {
    explicit State(const processors::machine::MachineConfig& machine) : caches(machine) {}
    NaiveCaches caches;
    Stage stage = Stage::search;
    std::list<Ray> queue;
    std::uint32_t slots = 0;
    std::optional<Ray> ray;
    Doing doing = Doing::nothing;
    Stage next = Stage::search;
    std::uint32_t target = 0;
    sim::Ticks since = 0;
    std::vector<Ray> aside;
    std::uint32_t granted = 0;
  };

  static Ray ray_of(const std::shared_ptr<Tree>& tree, std::uint32_t number) {
    Ray ray;
    ray.tree = tree;
    ray.number = number;
    ray.word = (*tree)[number].begin;
    return ray;
  }

  // ---- Times of steps.

  // What a step takes for the objects that a leaf lists, or for all else.
  sim::Ticks step(std::uint32_t who, const Ray& ray, bool objects) {
    sim::Ticks time = 0;
    for (const NaiveAction& action : program_.actions_of(ray.word, ray.logged().operand())) {
      if (is_of_objects(action) != objects) {
        continue;
      }
      if (action.what != NaiveAction::What::refer) {
        time += action.time;
        continue;
      }
      NaiveCaches& caches = states_[who].caches;
      const bool hit = caches.refer(action.kind, action.address);
      if (counted_ != nullptr) {
        counted_->refer(who, caches.number_of(action.kind), action, action.address / program_.unit(), hit);
      }
      if (hit) {
        time += program_.ticks().hit;
        continue;
      }
      const std::int64_t bytes = caches.present() ? program_.unit() : action.bytes;
      const std::int64_t beats = (bytes + machine_.local.width - 1) / machine_.local.width;
      const sim::Ticks read = machine_.local.clock.cycles(machine_.local.access_cycles) +
                              beats * machine_.local.clock.cycles(machine_.local.cycles_per_beat);
      time += read;
      if (counted_ != nullptr) {
        counted_->wait(action, read);
      }
    }
    return time;
  }

  // Takes a ray through its steps of a stage.
  sim::Ticks serve(std::uint32_t who, Stage stage, Ray& ray) {
    const std::uint32_t* const last = ray.logged().end;
    if (stage == Stage::nearest) {
      const sim::Ticks time = step(who, ray, true);
      ray.word += processors::program::step_words(ray.word);
      ray.record_read = false;
      return time;
    }
    sim::Ticks time = 0;
    while (ray.word != last && processors::flow::stage_of(ray.word) == stage) {
      time += step(who, ray, false);
      if (processors::flow::visits_leaf(ray.word) &&
          processors::flow::entries_read(ray.word, log_.topology) > 0) {
        ray.record_read = true;
        break;
      }
      ray.lit = ray.lit || processors::program::step_of(*ray.word) == processors::program::Step::light;
      ray.word += processors::program::step_words(ray.word);
    }
    return time;
  }

  // ---- Events.

  void post(sim::Ticks time, Class what, std::uint32_t who) { events_.emplace(time, what, who); }

  void run() {
    if (!cameras_.empty()) {
      post(host_ready_, admit, 0);
    }
    while (!events_.empty()) {
      const auto [time, what, who] = *events_.begin();
      events_.erase(events_.begin());
      now_ = time;
      if (what == done) {
        on_done(who);
      } else if (what == wake) {
        look(who);
      } else {
        on_admit();
      }
    }
  }

  void send_next(std::uint32_t who, Stage stage) {
    states_[who].doing = Doing::sending;
    states_[who].next = stage;
    nodes[who].messaging += send_;
  }

  void on_done(std::uint32_t who) {
    State& state = states_[who];
    switch (state.doing) {
      case Doing::contributing: {
        ++nodes[who].counts.contributions;
        const sim::Ticks arrival =
            network_->send(now_, who, machine_.nodes, machine_.messages.contribution_bytes).arrival;
        path.contributed(who, now_, arrival);
        end = std::max(end, arrival);
        end_ray(who);
        return;
      }
      case Doing::ending:
        end_ray(who);
        return;
      case Doing::sending: {
        const std::optional<std::uint32_t> target = choose(state.next);
        if (!target) {
          state.doing = Doing::blocked;
          state.since = now_;
          waiting_[static_cast<std::size_t>(state.next)].push_back(who);
          return;
        }
        claim(*target);
        state.target = *target;
        break;
      }
      default:
        nodes[who].queue_full_wait += now_ - state.since;
    }
    ++nodes[who].counts.passed_on;
    deliver(*state.ray, state.target,
            network_->send(now_, who, state.target, machine_.messages.ray_bytes).arrival, who);
    free(who);
  }

  void end_ray(std::uint32_t who) {
    State& state = states_[who];
    ++nodes[who].counts.ended;
    const Ray ray = *state.ray;
    std::vector<Ray> children;
    for (std::uint32_t child = ray.logged().first_child; child != processors::program::LoggedRay::none;
         child = (*ray.tree)[child].next_sibling) {
      children.push_back(ray_of(ray.tree, child));
    }
    nodes[who].counts.made += static_cast<std::int64_t>(children.size());
    if (children.empty()) {
      --in_flight_;
      share_out(who);
      free(who);
      return;
    }
    state.ray = children.front();
    for (std::size_t i = children.size(); i-- > 1;) {
      state.aside.push_back(children[i]);
      requests_.push_back(who);
    }
    nodes[who].counts.most_set_aside =
        std::max(nodes[who].counts.most_set_aside, static_cast<std::int64_t>(state.aside.size()));
    send_next(who, Stage::search);
    post(now_ + send_, done, who);
    path.worked(who, {now_, now_ + send_, who});
    share_out(who);
  }

  void free(std::uint32_t who) {
    states_[who].ray.reset();
    states_[who].doing = Doing::nothing;
    states_[who].since = now_;
    nodes[who].finish = now_;
    path.finished(who, now_);
    end = std::max(end, now_);
    look(who);
  }

  void look(std::uint32_t who) {
    State& state = states_[who];
    Node& node = nodes[who];
    if (state.ray) {
      return;
    }
    if (state.granted > 0) {
      --state.granted;
      node.message_wait += now_ - state.since;
      state.ray = state.aside.back();
      state.aside.pop_back();
      send_next(who, Stage::search);
      post(now_ + send_, done, who);
      path.worked(who, {now_, now_ + send_, who});
      return;
    }
    if (state.queue.empty()) {
      return;
    }
    if (state.queue.front().arrival > now_) {
      post(state.queue.front().arrival, wake, who);
      return;
    }
    node.message_wait += now_ - state.since;
    state.ray = state.queue.front();
    state.queue.pop_front();
    --state.slots;
    path.took(who, state.ray->sender, state.ray->message);
    ++node.counts.taken;
    node.counts.queued += now_ - state.ray->arrival;
    if (auto& waiting = waiting_[static_cast<std::size_t>(state.stage)]; !waiting.empty()) {
      const std::uint32_t first = waiting.front();
      waiting.pop_front();
      ++state.slots;
      path.let_go(first, who, now_);
      if (first == machine_.nodes) {
        host_target_ = who;
        post(now_, admit, 0);
      } else {
        states_[first].doing = Doing::granted;
        states_[first].target = who;
        post(now_, done, first);
      }
    }
    Ray& ray = *state.ray;
    const sim::Ticks served = serve(who, state.stage, ray);
    node.served += served;
    node.messaging += receive_;
    sim::Ticks at = now_ + receive_ + served;
    const bool shadow = ray.logged().kind == processors::program::RayKind::shadow;
    if (ray.word != ray.logged().end) {
      send_next(who, ray.record_read ? Stage::nearest : processors::flow::stage_of(ray.word));
      at += send_;
    } else if (state.stage != Stage::shade &&
               !(shadow && ray.logged().first_child == processors::program::LoggedRay::none)) {
      send_next(who, Stage::shade);
      at += send_;
    } else if (!shadow || ray.lit || ray.number == 0) {
      state.doing = Doing::contributing;
      node.messaging += send_;
      at += send_;
    } else {
      state.doing = Doing::ending;
    }
    post(at, done, who);
    path.worked(who, {now_, at, who});
  }

  std::optional<std::uint32_t> choose(Stage stage) const {
    std::optional<std::uint32_t> best;
    std::uint32_t least = 0;
    for (std::uint32_t who = 0; who < states_.size(); ++who) {
      const State& state = states_[who];
      const std::uint32_t load = state.slots + (state.ray ? 1 : 0);
      if (state.stage == stage && state.slots < machine_.pipeline.queue && (!best || load < least)) {
        best = who;
        least = load;
      }
    }
    return best;
  }
  void claim(std::uint32_t who) {
    nodes[who].counts.longest_queue =
        std::max(nodes[who].counts.longest_queue, std::int64_t{++states_[who].slots});
  }
  void deliver(Ray ray, std::uint32_t who, sim::Ticks arrival, std::uint32_t sender) {
    ray.arrival = arrival;
    ray.sender = sender;
    ray.message = {now_, arrival, sender == machine_.nodes ? who : sender,
                   processors::path::PathKind::network};
    auto at = states_[who].queue.begin();
    while (at != states_[who].queue.end() && at->arrival <= arrival) {
      ++at;
    }
    states_[who].queue.insert(at, ray);
    post(arrival, wake, who);
  }

  // ---- The host.

  void share_out(std::uint32_t by) {
    while (!requests_.empty() && in_flight_ < limit_) {
      enter();
      ++states_[requests_.front()].granted;
      if (!states_[requests_.front()].ray) {
        path.let_go(requests_.front(), by, now_);
      }
      post(now_, wake, requests_.front());
      requests_.pop_front();
    }
    if (!host_busy_ && in_flight_ < limit_ && !cameras_.empty()) {
      host_busy_ = true;
      path.let_go(machine_.nodes, by, now_);
      post(std::max(now_, host_ready_), admit, 0);
    }
  }
  void enter() { most_in_flight_seen = std::max(most_in_flight_seen, ++in_flight_); }

  void on_admit() {
    if (host_target_) {
      send_camera(*host_target_);
      host_target_.reset();
    }
    while (!cameras_.empty() && in_flight_ < limit_) {
      host_busy_ = true;
      if (host_ready_ > now_) {
        post(host_ready_, admit, 0);
        return;
      }
      enter();
      const std::optional<std::uint32_t> target = choose(Stage::search);
      if (!target) {
        waiting_[0].push_back(machine_.nodes);
        return;
      }
      claim(*target);
      send_camera(*target);
    }
    host_busy_ = false;
  }
  void send_camera(std::uint32_t target) {
    const std::uint32_t host = machine_.nodes;
    if (!host_began_) {
      path.worked(host, {0, host_ready_, target, processors::path::PathKind::dispatch});
      host_began_ = true;
    }
    host_ready_ = now_ + machine_.host.clock.cycles(machine_.host.occupancy_cycles);
    path.worked(host, {now_, host_ready_, target, processors::path::PathKind::dispatch});
    deliver(cameras_.front(), target, network_->send(now_, host, target, machine_.messages.ray_bytes).arrival,
            host);
    cameras_.pop_front();
  }

  const processors::program::WorkLog& log_;
  const processors::machine::MachineConfig& machine_;
  NaiveProgram program_;
  NaiveCounts* counted_;
  std::unique_ptr<memory::Network> network_;
  sim::Ticks send_;
  sim::Ticks receive_;
  sim::Ticks host_ready_;
  std::vector<std::deque<std::uint32_t>> waiting_;  // for a slot of each stage
  std::vector<State> states_;
  std::deque<Ray> cameras_;
  std::deque<std::uint32_t> requests_;
  std::set<std::tuple<sim::Ticks, int, std::uint32_t>> events_;
  std::optional<std::uint32_t> host_target_;
  std::uint32_t limit_ = 0;
  std::uint32_t in_flight_ = 0;
  bool host_busy_ = false;
  bool host_began_ = false;
  sim::Ticks now_ = 0;
};

}  // namespace marti::test
