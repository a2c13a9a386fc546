#include "processors/flow/pipeline/pipeline_core.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::processors::flow {

PipelineCore::PipelineCore(const FlowParts& parts)
    : FlowNodesBase<PipelineCore>(parts),
      nodes_(parts.input.config.all_nodes()),
      clusters_(parts.input.config.clusters),
      set_aside_(std::size_t{parts.input.config.clusters} * parts.input.config.pipeline.shade),
      queue_slots_(parts.input.config.pipeline.queue),
      send_(parts.input.config.clock.cycles(parts.input.config.messages.send_cycles)),
      receive_(parts.input.config.clock.cycles(parts.input.config.messages.receive_cycles)) {
  const machine::PipelineConfig& pipeline = input_.config.pipeline;
  const std::array<std::uint32_t, machine::pipeline_stages> sizes = {pipeline.search, pipeline.nearest,
                                                                     pipeline.shade};
  std::uint32_t node = 0;
  for (std::uint32_t cluster = 0; cluster < input_.config.clusters; ++cluster) {
    for (std::uint32_t stage = 0; stage < machine::pipeline_stages; ++stage) {
      stages_.push_back({node, LoadOrder(sizes[stage])});
      for (const std::uint32_t end = node + sizes[stage]; node != end; ++node) {
        nodes_[node].stage = static_cast<Stage>(stage);
        nodes_[node].state = static_cast<std::uint32_t>(stages_.size() - 1);
        nodes_[node].place = node - stages_.back().first;
      }
    }
  }
}

void PipelineCore::start(std::uint64_t seed) {
  for (const std::uint32_t cluster : first_order(seed)) {
    post(FlowEvent::admit, host_.ready_at(cluster), cluster);
  }
}

void PipelineCore::report(FlowResult& result) const {
  FlowNodesBase<PipelineCore>::report(result);
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
    result.nodes[node].longest_queue = nodes_[node].most_queued;
  }
}

void PipelineCore::end_nodes() {
  for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
    statistics_[node].finish = nodes_[node].since;
    end_ = std::max(end_, nodes_[node].since);
  }
}

// ---- The ray in service.

// The node has taken the ray's last step.
void PipelineCore::worked_to_end(std::uint32_t node, const FlowRay& ray, sim::Ticks time) {
  Node& at = nodes_[node];
  const bool shadow = ray.kind == program::RayKind::shadow;
  const bool ends_anywhere =
      shadow && trees_.ray(ray.tree, ray.number).first_child == program::LoggedRay::none;
  if (at.stage != Stage::shade && !ends_anywhere) {
    compose(node, at, Stage::shade, time);
    return;
  }
  at.phase = Phase::ending;
  if (!shadow || ray.lit || ray.number == 0) {
    at.phase = Phase::contributing;
    spend(node, cost::Activity::messaging, send_);
    time = sim::add_ticks(time, send_);
  }
  post(FlowEvent::done, time, node);
}

void PipelineCore::watch_done(std::uint32_t node, sim::Ticks now) {
  if (nodes_[node].phase == Phase::granted) {
    watch(node, walk::NodeState::queue_full_wait, now, place_of(node));
  } else {
    watch_ray(node, now, ray_of(node).word);
  }
}

// The rest of done(), for a node that does not look for a slot.
void PipelineCore::done_otherwise(std::uint32_t node, sim::Ticks now) {
  Node& at = nodes_[node];
  switch (at.phase) {
    case Phase::contributing:
      send_contribution(node, now);
      end_ray(node, now);
      return;
    case Phase::ending:
      end_ray(node, now);
      return;
    case Phase::granted:
      spend(node, cost::Activity::queue_full_wait, now - at.since);
      dispatch(node, at, now);
      return;
    case Phase::sending:
    case Phase::idle:
    case Phase::working:
    case Phase::blocked:
      break;
  }
  throw sim::InternalError("a node of the pipeline finishes what it has not begun");
}

// The node waits for a slot of the stage that its ray goes to.
void PipelineCore::block(std::uint32_t node, sim::Ticks now) {
  nodes_[node].phase = Phase::blocked;
  nodes_[node].since = now;
  wait_for_slot(cluster_of(node), nodes_[node].next, node);
}

// The ray in service has ended. Its first child takes its place; the others are set aside.
void PipelineCore::end_ray(std::uint32_t node, sim::Ticks now) {
  Node& at = nodes_[node];
  FlowRay& ray = ray_of(node);
  const std::uint32_t tree = ray.tree;
  const std::uint32_t first = trees_.ray(tree, ray.number).first_child;
  ++counts_[node].ended;
  if (first == program::LoggedRay::none) {
    trees_.end_ray(tree);
    rays_.give_back(at.ray);
    at.ray = none;
    host_.leave(cluster_of(node));
    give_credits(node, now);
    next_work(node, at, now);
    return;
  }
  std::vector<SetAside>& stack = set_aside_of(node);
  const std::size_t below = stack.size();
  for (std::uint32_t child = trees_.ray(tree, first).next_sibling; child != program::LoggedRay::none;
       child = trees_.ray(tree, child).next_sibling) {
    stack.push_back({tree, child});
  }
  std::reverse(stack.begin() + static_cast<std::ptrdiff_t>(below), stack.end());
  const std::size_t more = stack.size() - below;
  for (std::size_t child = 0; child <= more; ++child) {
    trees_.begin_ray(tree);
  }
  trees_.end_ray(tree);
  counts_[node].made += static_cast<std::int64_t>(more) + 1;
  counts_[node].most_set_aside =
      std::max(counts_[node].most_set_aside, static_cast<std::int64_t>(stack.size()));
  start_ray(ray, tree, first);
  compose(node, at, stage_of(ray.word), now);
  if (more != 0) {
    std::deque<std::uint32_t>& requests = clusters_[cluster_of(node)].requests;
    requests.insert(requests.end(), more, node);
    give_credits(node, now);
  }
}

void PipelineCore::start_ray(FlowRay& ray, std::uint32_t tree, std::uint32_t number) const {
  const program::LoggedRay& logged = trees_.ray(tree, number);
  ray.word = logged.begin;
  ray.end = logged.end;
  ray.tree = tree;
  ray.number = number;
  ray.kind = logged.kind;
  ray.record_read = false;
  ray.lit = false;
}

// The ray set aside last enters, with the credit that the node was granted.
void PipelineCore::send_set_aside(std::uint32_t node, sim::Ticks now) {
  Node& at = nodes_[node];
  spend(node, cost::Activity::message_wait, now - at.since);
  watch(node, walk::NodeState::message_wait, now);
  --at.granted;
  std::vector<SetAside>& stack = set_aside_of(node);
  const SetAside next = stack.back();
  stack.pop_back();
  at.ray = rays_.take();
  start_ray(rays_[at.ray], next.tree, next.number);
  compose(node, at, stage_of(rays_[at.ray].word), now);
}

// ---- Credits: how many rays may be in flight.

// Rays set aside get credits before new camera rays. Node `by` has ended a ray or asks for credits.
void PipelineCore::give_credits(std::uint32_t by, sim::Ticks now) {
  const std::uint32_t cluster = cluster_of(by);
  Cluster& at = clusters_[cluster];
  while (!at.requests.empty() && host_.has_credit(cluster)) {
    const std::uint32_t node = at.requests.front();
    at.requests.pop_front();
    host_.enter(cluster);
    ++nodes_[node].granted;
    if (nodes_[node].phase == Phase::idle) {
      tell_let_go(node, by, now);
      post_wake(node, nodes_[node], now);
    }
  }
  if (at.host == Phase::idle && host_.has_credit(cluster) && host_.has_ray(cluster)) {
    at.host = Phase::sending;
    tell_let_go(host_link(cluster), by, now);
    post(FlowEvent::admit, std::max(now, host_.ready_at(cluster)), cluster);
  }
}

void PipelineCore::admit(std::uint32_t cluster, sim::Ticks now) {
  Cluster& at = clusters_[cluster];
  if (at.host == Phase::granted) {
    send_from_host(cluster, at.target, now);
  }
  for (;;) {
    if (!host_.has_ray(cluster) || !host_.has_credit(cluster)) {
      at.host = Phase::idle;
      return;
    }
    at.host = Phase::sending;
    if (host_.ready_at(cluster) > now) {
      post(FlowEvent::admit, host_.ready_at(cluster), cluster);
      return;
    }
    host_.enter(cluster);
    const std::uint32_t target = slot_of(stage_state(cluster, Stage::search));
    if (target == LoadOrder::none) {
      at.host = Phase::blocked;
      wait_for_slot(cluster, Stage::search, input_.config.all_nodes() + cluster);
      return;
    }
    reserve(nodes_[target]);
    send_from_host(cluster, target, now);
  }
}

void PipelineCore::send_from_host(std::uint32_t cluster, std::uint32_t target, sim::Ticks now) {
  const std::uint32_t ray = rays_.take();
  start_ray(rays_[ray], trees_.open(host_.send(cluster, now)), 0);
  if (input_.causes != nullptr) {
    input_.causes->sent_camera_ray(cluster, target, now);
  }
  put(ray, target, send_camera_ray(target, ray, now));
}

// ---- Slots of the queues.

std::uint32_t& PipelineCore::next_waiter_of(std::uint32_t waiter) {
  const std::uint32_t nodes = input_.config.all_nodes();
  return waiter < nodes ? nodes_[waiter].next_waiter : clusters_[waiter - nodes].next_waiter;
}

void PipelineCore::wait_for_slot(std::uint32_t cluster, Stage stage, std::uint32_t waiter) {
  StageState& state = stage_state(cluster, stage);
  next_waiter_of(waiter) = none;
  if (state.first_waiter == none) {
    state.first_waiter = waiter;
  } else {
    next_waiter_of(state.last_waiter) = waiter;
  }
  state.last_waiter = waiter;
}

// A slot of the node has become free; the node or host that has waited longest gets it.
void PipelineCore::give_slot(std::uint32_t node, sim::Ticks now) {
  StageState& state = stages_[nodes_[node].state];
  const std::uint32_t waiter = state.first_waiter;
  state.first_waiter = next_waiter_of(waiter);
  ++nodes_[node].queue.count;
  tell_let_go(waiter, node, now);  // the host's links are numbered alike
  const std::uint32_t nodes = input_.config.all_nodes();
  if (waiter < nodes) {
    nodes_[waiter].phase = Phase::granted;
    nodes_[waiter].target = node;
    post(FlowEvent::done, now, waiter);
  } else {
    clusters_[waiter - nodes].host = Phase::granted;
    clusters_[waiter - nodes].target = node;
    post(FlowEvent::admit, now, waiter - nodes);
  }
}

void PipelineCore::tell_let_go(std::uint32_t waiter, std::uint32_t by, sim::Ticks now) const {
  if (input_.causes != nullptr) {
    input_.causes->let_go(waiter, by, now);
  }
}

std::vector<PipelineCore::SetAside>& PipelineCore::set_aside_of(std::uint32_t node) {
  return set_aside_[std::size_t{cluster_of(node)} * input_.config.pipeline.shade + nodes_[node].place];
}

}  // namespace marti::processors::flow
