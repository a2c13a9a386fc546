// The nodes of the pipeline, except for the work inside a node: queues, slots, credits and messages.
#pragma once

#include <array>
#include <deque>
#include <limits>
#include <vector>

#include "processors/flow/flow_nodes_base.h"
#include "processors/flow/load_order.h"
#include "processors/flow/pipeline/stages.h"
#include "processors/flow/pixel_trees.h"
#include "processors/flow/ray_queues.h"

namespace marti::processors::flow {

class PipelineCore : public FlowNodesBase<PipelineCore> {
 public:
  void start(std::uint64_t seed) override;
  void report(FlowResult& result) const override;

  /// A read that the node waits for has been served.
  virtual void read_done(std::uint32_t node, const memory::Service& service) = 0;

 protected:
  /// What a node does. After `working` it composes its message; in `blocked` it waits for a slot; in
  /// `granted` another node has freed a slot for it, and the event in which it sends has yet to be handled.
  enum class Phase : std::uint8_t { idle, working, contributing, ending, sending, blocked, granted };

  struct alignas(64) Node {
    sim::Ticks since = 0;          ///< idle or blocked since then
    sim::Ticks wake_at = no_wake;  ///< the earliest wake event that is posted
    RayQueue queue;
    std::uint32_t most_queued = 0;      ///< most slots of the queue in use at a time
    std::uint32_t ray = RayPool::none;  ///< in service
    std::uint32_t target = 0;           ///< granted: the node whose slot it has
    std::uint32_t next_waiter = 0;      ///< blocked: the next node in the list of waiting ones
    std::uint32_t granted = 0;          ///< number of credits for rays set aside
    std::uint32_t state = 0;            ///< index of its stage in stages_
    std::uint32_t place = 0;            ///< its number in the stage
    Stage stage = Stage::search;
    Stage next = Stage::search;  ///< sending: the stage that the ray goes to
    Phase phase = Phase::idle;
  };
  static_assert(sizeof(Node) == 64);

  explicit PipelineCore(const FlowParts& parts);

  /// Puts the node at the first of its ray's steps and lets it work on those of its stage until it needs
  /// something shared.
  virtual void serve(std::uint32_t node, FlowRay& ray) = 0;

  /// The node has taken all of the ray's steps that belong to its stage, the last one at `time`.
  void worked(std::uint32_t node, FlowRay& ray, sim::Ticks time) {
    Node& at = nodes_[node];
    if (ray.word != ray.end) {
      compose(node, at, ray.record_read ? Stage::nearest : stage_of(ray.word), time);
    } else {
      worked_to_end(node, ray, time);
    }
  }
  // Handle the events of these classes.
  void done(std::uint32_t node, sim::Ticks now) {
    Node& at = nodes_[node];
    if (input_.observer != nullptr) [[unlikely]] {
      watch_done(node, now);
    }
    if (at.phase != Phase::sending) {
      done_otherwise(node, now);
      return;
    }
    at.target = slot_of(stage_state(cluster_of(node), at.next));
    if (at.target == LoadOrder::none) {
      block(node, now);
      return;
    }
    reserve(nodes_[at.target]);
    dispatch(node, at, now);
  }
  void wake(std::uint32_t node, sim::Ticks now) {
    Node& at = nodes_[node];
    if (at.wake_at <= now) {
      at.wake_at = no_wake;
    }
    if (at.phase == Phase::idle) {
      find_work(node, at, now);
    }
  }
  void admit(std::uint32_t cluster, sim::Ticks now);
  /// After the run: sets what is known of each node then.
  void end_nodes();

  [[nodiscard]] FlowRay& ray_of(std::uint32_t node) { return rays_[nodes_[node].ray]; }
  [[nodiscard]] const program::LoggedRay& logged(const FlowRay& ray) const {
    return trees_.ray(ray.tree, ray.number);
  }
  /// The pixel that the ray in service is for.
  [[nodiscard]] walk::PixelPlace place_of(std::uint32_t node) { return trees_.place(ray_of(node).tree); }
  /// Tells of the node's work up to `to` for its ray, which has come to `word`.
  void watch_ray(std::uint32_t node, sim::Ticks to, const std::uint32_t* word) {
    watch_work(node, to, place_of(node), word + (ray_of(node).record_read ? program::step_words(word) : 0));
  }

  sim::LargeVector<Node> nodes_;

 private:
  static constexpr sim::Ticks no_wake = std::numeric_limits<sim::Ticks>::max();
  static constexpr std::uint32_t none = RayPool::none;

  // The nodes of one stage of a cluster, and the list of nodes that wait for a slot in it.
  struct StageState {
    std::uint32_t first = 0;
    LoadOrder order;
    std::uint32_t first_waiter = none;
    std::uint32_t last_waiter = none;
  };
  struct SetAside {
    std::uint32_t tree;
    std::uint32_t number;
  };
  // The nodes of a cluster that have set rays aside, in the order in which they did, and the host's state.
  struct Cluster {
    std::deque<std::uint32_t> requests;
    Phase host = Phase::idle;  // idle: waits for a credit, or has nothing to send
    std::uint32_t target = 0;
    std::uint32_t next_waiter = none;
  };

  StageState& stage_state(std::uint32_t cluster, Stage stage) {
    return stages_[cluster * machine::pipeline_stages + static_cast<std::uint32_t>(stage)];
  }
  void worked_to_end(std::uint32_t node, const FlowRay& ray, sim::Ticks time);
  void watch_done(std::uint32_t node, sim::Ticks now);
  void done_otherwise(std::uint32_t node, sim::Ticks now);
  void block(std::uint32_t node, sim::Ticks now);
  void end_ray(std::uint32_t node, sim::Ticks now);
  void send_set_aside(std::uint32_t node, sim::Ticks now);
  void give_credits(std::uint32_t by, sim::Ticks now);
  void give_slot(std::uint32_t node, sim::Ticks now);
  void tell_let_go(std::uint32_t waiter, std::uint32_t by, sim::Ticks now) const;
  void wait_for_slot(std::uint32_t cluster, Stage stage, std::uint32_t waiter);
  void send_from_host(std::uint32_t cluster, std::uint32_t target, sim::Ticks now);
  std::uint32_t& next_waiter_of(std::uint32_t waiter);
  void start_ray(FlowRay& ray, std::uint32_t tree, std::uint32_t number) const;
  std::vector<SetAside>& set_aside_of(std::uint32_t node);

  // The node of a stage that gets the next ray; LoadOrder::none when all queues are full.
  static std::uint32_t slot_of(StageState& state) {
    const std::uint32_t least = state.order.least();
    return least == LoadOrder::none ? least : state.first + least;
  }
  // The node's load is the number of rays in its queue and in service; a node without a free slot gets no
  // rays.
  void refresh(const Node& at) {
    const std::uint32_t load = at.queue.count + (at.phase != Phase::idle ? 1 : 0);
    stages_[at.state].order.set(at.place, at.queue.count < queue_slots_ ? load : LoadOrder::none);
  }
  void reserve(Node& at) {
    at.most_queued = std::max(at.most_queued, ++at.queue.count);
    refresh(at);
  }
  // Composes, from `now` on, the message that takes the node's ray to stage `next`.
  void compose(std::uint32_t node, Node& at, Stage next, sim::Ticks now) {
    at.phase = Phase::sending;
    at.next = next;
    spend(node, cost::Activity::messaging, send_);
    post(FlowEvent::done, sim::add_ticks(now, send_), node);
  }
  // Sends the node's ray to its target, where a slot is reserved for it.
  void dispatch(std::uint32_t node, Node& at, sim::Ticks now) {
    put(at.ray, at.target, send_ray(node, at.target, at.ray, now));
    at.ray = none;
    next_work(node, at, now);
  }
  // Puts a ray that was just sent into the slot reserved for it; it arrives at `arrival`.
  void put(std::uint32_t ray, std::uint32_t node, sim::Ticks arrival) {
    Node& at = nodes_[node];
    rays_[ray].arrival = arrival;
    at.queue.insert(rays_, ray);
    if (at.phase == Phase::idle) {
      post_wake(node, at, arrival);
    }
  }
  void next_work(std::uint32_t node, Node& at, sim::Ticks now) {
    at.phase = Phase::idle;
    at.since = now;
    if (at.wake_at <= now) {
      at.wake_at = no_wake;
    }
    find_work(node, at, now);
  }
  // Gives an idle node the next thing to do, if there is any.
  void find_work(std::uint32_t node, Node& at, sim::Ticks now) {
    if (at.granted != 0) [[unlikely]] {
      send_set_aside(node, now);
    } else if (at.queue.head != none) {
      const sim::Ticks arrival = rays_[at.queue.head].arrival;
      if (arrival <= now) {
        take(node, at, now);
        return;
      }
      post_wake(node, at, arrival);
    }
    refresh(at);
  }
  void take(std::uint32_t node, Node& at, sim::Ticks now) {
    spend(node, cost::Activity::message_wait, now - at.since);
    spend(node, cost::Activity::messaging, receive_);
    at.ray = at.queue.pop(rays_);
    if (input_.observer != nullptr) [[unlikely]] {
      watch(node, walk::NodeState::message_wait, now);
      if (input_.causes != nullptr) {
        input_.causes->took(node, at.ray, now);
      }
    }
    FlowRay& ray = rays_[at.ray];
    FlowCounts& counts = counts_[node];
    ++counts.taken;
    counts.queued += now - ray.arrival;
    if (stages_[at.state].first_waiter != none) {
      give_slot(node, now);
    }
    at.phase = Phase::working;
    refresh(at);
    serve(node, ray);
  }
  void post_wake(std::uint32_t node, Node& at, sim::Ticks time) {
    if (time < at.wake_at) {
      at.wake_at = time;
      post(FlowEvent::wake, time, node);
    }
  }

  PixelTrees trees_;
  RayPool rays_;
  std::vector<StageState> stages_;
  std::vector<Cluster> clusters_;
  std::vector<std::vector<SetAside>> set_aside_;  // for each shade node, cluster by cluster
  std::uint32_t queue_slots_;
  sim::Ticks send_;
  sim::Ticks receive_;
};

}  // namespace marti::processors::flow
