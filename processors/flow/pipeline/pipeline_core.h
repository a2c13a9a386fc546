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

namespace marti::processors {

class PipelineCore : public FlowNodesBase<PipelineCore> {
 public:
  void start(std::uint64_t seed) override;
  void handle(const sim::Event& event) override;

  /// A read that the node waits for has been served.
  virtual void read_done(std::uint32_t node, const memory::Service& service) = 0;

 protected:
  /// What a node does. After `working` it composes its message; in `blocked` it waits for a slot; in
  /// `granted` it has a slot and sends at the same instant.
  enum class Phase : std::uint8_t { idle, working, contributing, ending, sending, blocked, granted };

  struct Node {
    RayQueue queue;
    std::uint32_t ray = RayPool::none;  ///< in service
    std::uint32_t target = 0;           ///< granted: the node whose slot it has
    std::uint32_t next_waiter = 0;      ///< blocked: the next node in the list of waiting ones
    std::uint32_t granted = 0;          ///< number of credits for rays set aside
    sim::Ticks since = 0;               ///< idle or blocked since then
    sim::Ticks wake_at = no_wake;       ///< the earliest wake event that is posted
    std::uint32_t state = 0;            ///< index of its stage in stages_
    std::uint32_t place = 0;            ///< its number in the stage
    Stage stage = Stage::search;
    Stage next = Stage::search;  ///< sending: the stage that the ray goes to
    Phase phase = Phase::idle;
  };

  explicit PipelineCore(const FlowParts& parts);

  /// Lets the node work on its ray's steps of its stage until it needs something shared.
  virtual void work(std::uint32_t node) = 0;
  /// Puts the node at the first of its ray's steps.
  virtual void begin(std::uint32_t node, FlowRay& ray) = 0;
  /// Starts a read that the node's walk needs.
  virtual void read(std::uint32_t node) = 0;

  /// The node has taken all of the ray's steps that belong to its stage, the last one at `time`.
  void worked(std::uint32_t node, FlowRay& ray, sim::Ticks time);

  [[nodiscard]] FlowRay& ray_of(std::uint32_t node) { return rays_[nodes_[node].ray]; }
  [[nodiscard]] const LoggedRay& logged(const FlowRay& ray) const { return trees_.ray(ray.tree, ray.number); }
  /// The pixel that the ray in service is for.
  [[nodiscard]] PixelPlace place_of(std::uint32_t node) { return trees_.place(ray_of(node).tree); }
  /// Tells of the node's work up to `to` for its ray, which has come to `word`.
  void watch_ray(std::uint32_t node, sim::Ticks to, const std::uint32_t* word) {
    watch_work(node, to, place_of(node), word + (ray_of(node).record_read ? step_words(word) : 0));
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
    return stages_[cluster * pipeline_stages + static_cast<std::uint32_t>(stage)];
  }
  void refresh(std::uint32_t node);
  void done(std::uint32_t node, sim::Ticks now);
  void wake(std::uint32_t node, sim::Ticks now);
  void admit(std::uint32_t cluster, sim::Ticks now);
  void compose(std::uint32_t node, Stage next, sim::Ticks now);
  void dispatch(std::uint32_t node, sim::Ticks now);
  void end_ray(std::uint32_t node, sim::Ticks now);
  void next_work(std::uint32_t node, sim::Ticks now);
  void take(std::uint32_t node, sim::Ticks now);
  void send_set_aside(std::uint32_t node, sim::Ticks now);
  void give_credits(std::uint32_t by, sim::Ticks now);
  std::uint32_t slot_of(std::uint32_t cluster, Stage stage);
  void wait_for_slot(std::uint32_t cluster, Stage stage, std::uint32_t waiter);
  void give_slot(std::uint32_t node, sim::Ticks now);
  void tell_let_go(std::uint32_t waiter, std::uint32_t by, sim::Ticks now) const;
  void reserve(std::uint32_t node);
  void put(std::uint32_t ray, std::uint32_t node, sim::Ticks arrival);
  void send_from_host(std::uint32_t cluster, std::uint32_t target, sim::Ticks now);
  std::uint32_t& next_waiter_of(std::uint32_t waiter);
  void post_wake(std::uint32_t node, sim::Ticks time);
  void start_ray(FlowRay& ray, std::uint32_t tree, std::uint32_t number) const;
  std::vector<SetAside>& set_aside_of(std::uint32_t node);

  PixelTrees trees_;
  RayPool rays_;
  std::vector<StageState> stages_;
  std::vector<Cluster> clusters_;
  std::vector<std::vector<SetAside>> set_aside_;  // for each shade node, cluster by cluster
  std::uint32_t queue_slots_;
  sim::Ticks send_;
  sim::Ticks receive_;
};

}  // namespace marti::processors
