#include "processors/path/path_recorder.h"

#include <algorithm>
#include <utility>

#include "sim/error.h"
#include "sim/key_error.h"

namespace marti::processors::path {

namespace {

constexpr const char* key = "record.critical_path";

sim::Ticks of(const cost::TimeDivision& time, cost::Activity activity) {
  return time[static_cast<std::size_t>(activity)];
}

sim::Ticks of_memory(const cost::TimeDivision& time) {
  return of(time, cost::Activity::transfer) + of(time, cost::Activity::bank_access);
}

}  // namespace

void check_critical_path(const machine::MachineConfig& config) {
  if (config.kind == machine::NodeKind::simt) {
    throw sim::KeyError(key,
                        "a cycle of a SIMT node has many causes, of which none is recorded; use node.kind = "
                        "\"core\"");
  }
  if (config.banks.dram && config.banks.dram->policy == memory::DramPolicy::frfcfs) {
    throw sim::KeyError(key,
                        "with dram.policy = \"frfcfs\" an access waits for whatever is chosen before it, "
                        "which is not recorded; use \"fcfs\"");
  }
}

void PathRecorder::begin(const walk::ReplayInput& input) {
  const machine::MachineConfig& config = input.config;
  check_critical_path(config);
  sim::ensure(input.causes == this && input.stripped == nullptr && input.sample == nullptr,
              "a critical path is recorded of whole frames only, step by step");
  builds_ = input.tree != nullptr;
  const bool rays_move = config.scheme != machine::Scheme::image;
  asks_host_ = !rays_move && config.host.assignment == machine::Assignment::dynamic;
  contexts_ = config.contexts;
  ports_ = config.ports_of_node();
  write_buffer_ = config.write_buffer;
  host_latency_ = config.host.clock.cycles(config.host.latency_cycles);
  host_occupancy_ = config.host.clock.cycles(config.host.occupancy_cycles);
  const std::size_t nodes = config.all_nodes();
  const std::size_t workers = builds_ ? contexts_ : 0;
  pieces_.take(nodes * (sizeof(Node) + (ports_ + write_buffer_ + workers) * sizeof(PathTip)) +
               course_bytes(config));
  ticks_ = cost::step_ticks(config, input.log);
  levels_.emplace(input.log, ticks_);
  pieces_.set_levels(*levels_);
  nodes_.resize(nodes);
  due_.resize(nodes * ports_);
  writes_.resize(nodes * write_buffer_);
  releases_.resize(nodes * workers);
  if (rays_move) {
    rays_.emplace(config, pieces_);
  }
}

void PathRecorder::worked(std::uint32_t node, const cost::NodeStatistics& statistics, walk::LogPlace place) {
  Node& n = nodes_[node];
  n.counted = statistics.time;
  cost::add_counted_time(ticks_, statistics.steps, statistics.references.all_hits(), n.counted);
  n.place = place;
}

void PathRecorder::spent(std::uint32_t node, walk::NodeState state, sim::Ticks from, sim::Ticks to,
                         walk::PixelPlace /*pixel*/) {
  Node& n = nodes_[node];
  switch (state) {
    case walk::NodeState::idle:
      return;
    case walk::NodeState::working:
      add_work(node, from, to);
      return;
    case walk::NodeState::transfer:
    case walk::NodeState::bank_access:
      n.waited += to - from;
      break;
    default:
      break;
  }
  n.wait = state;
  n.wait_end = to;
}

void PathRecorder::add_work(std::uint32_t node, sim::Ticks from, sim::Ticks to) {
  (void)tip_at(node, from);
  Node& n = nodes_[node];
  const PathOwner owner = {node, n.place};
  std::array<sim::Ticks, path_kinds> parts{};
  sim::Ticks rest = to - from;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(cost::Activity::messaging); ++i) {
    parts[i] = n.counted[i] - n.seen[i];
    rest -= parts[i];
  }
  sim::Ticks& own = parts[static_cast<std::size_t>(PathKind::own_memory)];
  own = of_memory(n.counted) - of_memory(n.seen) - n.waited;
  rest -= own;
  // Building is counted by its steps, which are not those in which its time is spent; it is what is left.
  sim::ensure(builds_ ? rest >= 0 : rest == 0, "a node has counted other work than it has spent time on");
  parts[static_cast<std::size_t>(PathKind::building)] += rest;
  for (std::size_t kind = 0; kind < path_kinds; ++kind) {
    n.tip = pieces_.append(n.tip, parts[kind], owner, static_cast<PathKind>(kind));
  }
  n.seen = n.counted;
  n.waited = 0;
}

const PathTip& PathRecorder::tip_at(std::uint32_t node, sim::Ticks now) {
  Node& n = nodes_[node];
  if (n.tip.end() != now) {
    sim::ensure(n.wait_end == now, "a node goes on before its wait has ended");
    n.tip = end_of_wait(node);
    sim::ensure(n.tip.end() == now, "a node's wait has ended for no known cause");
  }
  return n.tip;
}

const PathTip& PathRecorder::end_of_wait(std::uint32_t node) const {
  const Node& n = nodes_[node];
  if (n.wait == walk::NodeState::queue_full_wait) {
    return writes_[entry_of(node, n.writes)];  // the oldest: its entry is the next one to be used
  }
  return n.wait == walk::NodeState::lock_wait ? releases_[node * contexts_ + n.context]
                                              : due_[node * ports_ + n.slot];
}

void PathRecorder::granted(std::uint32_t node, std::uint32_t context, sim::Ticks asked, sim::Ticks start) {
  if (!asks_host_) {
    return;
  }
  // When the frame begins all contexts ask, and the first of them may have gone on before the others do.
  const PathTip& begin = nodes_[node].begin;
  const PathTip& asking = begin.end() == asked ? begin : tip_at(node, asked);
  const PathOwner owner = {node, {}};
  const PathTip before = later_of(asking, host_);
  host_ = pieces_.append(before, host_occupancy_, owner, PathKind::dispatch);
  PathTip grant = pieces_.append(before, host_latency_, owner, PathKind::dispatch);
  sim::ensure(grant.end() == start, "the host has granted a packet at another time than it was free");
  due_[node * ports_ + context] = std::move(grant);
}

void PathRecorder::prefetched(std::uint32_t node, std::uint32_t slot, sim::Ticks from, sim::Ticks to) {
  const PathTip& tip = tip_at(node, from);
  due_[node * ports_ + slot] =
      pieces_.append(tip, to - from, {node, nodes_[node].place}, PathKind::cache_access);
}

void PathRecorder::wait_ended(std::uint32_t node, std::uint32_t context, std::uint32_t slot) {
  Node& n = nodes_[node];
  // After its last wait the node may have begun this one without any work or transaction.
  if (n.tip.end() < n.wait_end) {
    (void)tip_at(node, n.wait_end);
  }
  n.context = context;
  n.slot = slot;
}

void PathRecorder::began_frame(sim::Ticks start_up) {
  const PathTip cause = first_that_ends_at(start_up);
  for (Node& node : nodes_) {
    if (node.tip.end() != start_up) {
      node.tip = cause;
    }
    node.begin = node.tip;
  }
}

void PathRecorder::published(std::uint32_t builder, std::uint32_t waiter) {
  releases_[waiter] = writes_[entry_of(builder, nodes_[builder].writes - 1)];
}

PathRequest PathRecorder::request(std::uint32_t port, const memory::Transaction& transaction, bool write,
                                  sim::Ticks now) {
  const auto node = static_cast<std::uint32_t>(port / ports_);
  const PathTip& tip = tip_at(node, now);
  if (write) {
    ++nodes_[node].writes;
  }
  return {transaction, tip, {node, write ? walk::LogPlace{} : nodes_[node].place}, write};
}

void PathRecorder::sent_camera_ray(std::uint32_t cluster, std::uint32_t to, sim::Ticks now) {
  rays_->send_camera_ray(cluster, to, now);
}

const PathTip& PathRecorder::sending(std::uint32_t sender, sim::Ticks now) {
  return rays_->is_host(sender) ? rays_->sending(sender) : tip_at(sender, now);
}

void PathRecorder::set_aside(std::uint32_t ray, std::uint32_t sender, sim::Ticks now) {
  rays_->ray(ray) = sending(sender, now);
}

void PathRecorder::sent(const walk::RayMessage& message) {
  if (message.ray == walk::RayMessage::none) {
    (void)rays_->send(sending(message.sender, message.sent), message);
    return;
  }
  PathTip& ray = rays_->ray(message.ray);
  if (!message.was_set_aside) {
    ray = sending(message.sender, message.sent);
  } else if (ray.end() != message.sent) {
    ray = tip_at(message.to, message.sent);
  }
  ray = rays_->send(ray, message);
}

void PathRecorder::took(std::uint32_t node, std::uint32_t ray, sim::Ticks now) {
  go_on(node, std::exchange(rays_->ray(ray), {}), now);
}

void PathRecorder::let_go(std::uint32_t waiter, std::uint32_t by, sim::Ticks now) {
  const PathTip& freed = tip_at(by, now);
  if (rays_->is_host(waiter)) {
    rays_->let_go(waiter, freed, now);
  } else {
    go_on(waiter, freed, now);
  }
}

void PathRecorder::go_on(std::uint32_t node, const PathTip& cause, sim::Ticks now) {
  Node& n = nodes_[node];
  if (n.tip.end() != now) {
    sim::ensure(cause.end() == now, "a node's wait for a ray or slot has ended for no known cause");
    n.tip = cause;
  }
}

void PathRecorder::read_done(std::uint32_t port, PathTip done) {
  // Where rays move a node waits for the read that it has asked for last, and does nothing else.
  (rays_ ? nodes_[port].tip : due_[port]) = std::move(done);
}

void PathRecorder::write_done(std::uint32_t port, PathTip done) {
  const auto node = static_cast<std::uint32_t>(port / ports_);
  writes_[entry_of(node, nodes_[node].writes_done++)] = std::move(done);
}

PathTip PathRecorder::first_that_ends_at(sim::Ticks time) const {
  for (const Node& node : nodes_) {
    if (node.tip.end() == time) {
      return node.tip;
    }
  }
  for (const std::vector<PathTip>* const tips : {&writes_, &due_}) {
    const auto tip =
        std::find_if(tips->begin(), tips->end(), [&](const PathTip& t) { return t.end() == time; });
    if (tip != tips->end()) {
      return *tip;
    }
  }
  sim::ensure(rays_ && rays_->last_contribution().end() == time,
              "nothing is known to end at the end of the frame");
  return rays_->last_contribution();
}

void PathRecorder::end(sim::Ticks time) {
  last_ = first_that_ends_at(time);
  path_ = add_up(pieces_, last_, static_cast<std::uint32_t>(nodes_.size()), *levels_);
  levels_.reset();
  host_ = {};
  rays_.reset();
  for (std::vector<PathTip>* const tips : {&due_, &writes_, &releases_}) {
    tips->clear();
  }
  nodes_.clear();
}

}  // namespace marti::processors::path
