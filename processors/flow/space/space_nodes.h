// Nodes of the space scheme; processors/replay/space.h describes what they do.
//
// A node's work on a ray touches only its own memory, so it is computed at once, and a single event stands
// for it: the time at which the node has finished with the ray and sends it on.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "processors/flow/flow_nodes_base.h"
#include "processors/flow/pixel_trees.h"
#include "processors/flow/ray_queues.h"
#include "processors/flow/space/space_plan.h"
#include "processors/walk/log_walker.h"
#include "sim/large_pages.h"
#include "sim/prefetch.h"

namespace marti::processors::flow {

/// `Caches` is one of node_caches.h, or CountedCaches. The members are described in node_array.h.
template <class Caches>
class SpaceNodes final : public FlowNodesBase<SpaceNodes<Caches>> {
  using Base = FlowNodesBase<SpaceNodes<Caches>>;
  friend Base;
  using Base::cluster_of;
  using Base::counts_;
  using Base::end_;
  using Base::host_;
  using Base::input_;
  using Base::port_of;
  using Base::post;
  using Base::spend;
  using Base::statistics_;
  using Base::tallies_;
  using Base::watch;
  using Base::watch_work;

 public:
  SpaceNodes(const FlowParts& parts, const SpacePlan& plan, Caches caches)
      : Base(parts),
        plan_(plan),
        owner_(plan.owner.data()),
        walker_(parts.input, std::move(caches)),
        nodes_(parts.input.config.all_nodes()),
        cursors_(parts.input.config.all_nodes()),
        admissions_(parts.input.config.clusters),
        slots_(parts.input.config.space.queue),
        send_(parts.input.config.clock.cycles(parts.input.config.messages.send_cycles)),
        receive_(parts.input.config.clock.cycles(parts.input.config.messages.receive_cycles)) {}

  void start(std::uint64_t seed) override {
    for (const std::uint32_t cluster : Base::first_order(seed)) {
      ask_for_rays(cluster, host_.ready_at(cluster));
    }
  }

  void handle(const sim::Event& event) override {
    switch (static_cast<FlowEvent>(event.event_class())) {
      case FlowEvent::step:
        run(event.component());
        break;
      case FlowEvent::done:
        done(event.component(), event.time);
        break;
      case FlowEvent::wake:
        wake(event.component(), event.time);
        break;
      case FlowEvent::admit:
        admit(event.component(), event.time);
        break;
      default:
        throw sim::InternalError("the nodes of the space scheme share no memory");
    }
  }

  void handle_in_order(const sim::Event& event) { handle(event); }  // there are none

  void run_all(sim::Engine& engine) override { engine.run_all(*this); }

  void prepare(const sim::Event& event) override {
    if (static_cast<FlowEvent>(event.event_class()) != FlowEvent::admit) {
      sim::prefetch(nodes_[event.component()]);
      sim::prefetch(cursors_[event.component()]);
      sim::prefetch(statistics_[event.component()]);
    }
  }

  void settle() override {
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      walker_.flush(Base::tallies_[node], Base::statistics_[node]);
    }
  }

  void finish() override {
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      Base::finish_node(node, walker_);
    }
  }

  void report(FlowResult& result) const override {
    Base::report(result);
    result.memory_bytes.clear();
    for (std::uint32_t cluster = 0; cluster < input_.config.clusters; ++cluster) {
      result.memory_bytes.insert(result.memory_bytes.end(), plan_.memory_bytes.begin(),
                                 plan_.memory_bytes.end());
    }
    result.regions = plan_.regions.size();
    result.top_nodes = plan_.regions.top_nodes;
    result.duplicated_primitives = plan_.duplicated_primitives;
    result.sampling_work = plan_.sampling_work;
  }

  walk::SecondLevelResult second_level() const override { return walker_.behind().second_level().result(); }

  walk::CacheCountResult cache_counts() const override { return walker_.counts(); }

  std::size_t bytes_per_node() const override {
    return sizeof(Node) + sizeof(walk::Cursor) + sizeof(cost::NodeStatistics) + sizeof(FlowCounts) +
           sizeof(walk::VisitTally) + sizeof(sim::Event) + rays_.bytes() / nodes_.size();
  }

 private:
  static constexpr sim::Ticks never = std::numeric_limits<sim::Ticks>::max();
  static constexpr std::uint32_t from_host = RayPool::none;

  struct Node {
    RayQueue queue;                         // rays waiting at the node and on their way to it
    RayQueue waiting;                       // rays set aside elsewhere for lack of a slot at this node
    std::uint32_t made = RayPool::none;     // list of the rays made here, the next one first
    std::uint32_t current = RayPool::none;  // the ray in service
    std::uint32_t set_aside = 0;            // number of rays in its memory that wait for slots elsewhere
    sim::Ticks wake_at = never;             // time of the valid wake event
  };

  // Whether an event for camera rays of a cluster is posted, and whether all of them are sent.
  struct Admission {
    bool posted = false;
    bool all_sent = false;
  };

  [[noreturn]] static void read_done(std::uint32_t /*node*/, const memory::Service& /*service*/) {
    throw sim::InternalError("the nodes of the space scheme share no memory");
  }

  // The number in its cluster of the node that holds the tree node which a step reads; RegionMap::top when
  // every node holds it or the step reads none.
  [[nodiscard]] std::uint32_t owner_of(std::uint32_t word) const {
    return program::visits_node(program::step_of(word)) ? owner_[program::operand_of(word)] : RegionMap::top;
  }

  // --- the host ---

  void ask_for_rays(std::uint32_t cluster, sim::Ticks time) {
    Admission& admission = admissions_[cluster];
    if (!admission.posted && !admission.all_sent) {
      admission.posted = true;
      post(FlowEvent::admit, time, cluster);
    }
  }

  // The host sends camera rays until none is left, the limit is reached, or the next is not due.
  void admit(std::uint32_t cluster, sim::Ticks now) {
    admissions_[cluster].posted = false;
    while (host_.has_credit(cluster)) {
      if (!host_.has_ray(cluster)) {
        admissions_[cluster].all_sent = true;
        return;
      }
      if (host_.ready_at(cluster) > now) {
        ask_for_rays(cluster, host_.ready_at(cluster));
        return;
      }
      host_.enter(cluster);
      const std::uint32_t tree = trees_.open(host_.send(cluster, now));
      const std::uint32_t ray = new_ray(tree, 0);
      const std::uint32_t to = cluster * input_.config.nodes + first_owner(rays_[ray]);
      if (input_.causes != nullptr) {
        input_.causes->sent_camera_ray(cluster, to, now);
      }
      send_or_set_aside(from_host, to, ray, now);
    }
  }

  // The node that a camera ray is sent to. Rays that visit only the top are dealt to the nodes in turn.
  [[nodiscard]] std::uint32_t first_owner(const FlowRay& ray) const {
    for (const std::uint32_t* word = ray.word; word != ray.end; word += program::step_words(word)) {
      if (const std::uint32_t owner = owner_of(*word); owner != RegionMap::top) {
        return owner;
      }
    }
    return static_cast<std::uint32_t>((host_.sent() - 1) % input_.config.nodes);
  }

  std::uint32_t new_ray(std::uint32_t tree, std::uint32_t number) {
    const std::uint32_t index = rays_.take();
    const program::LoggedRay& logged = trees_.ray(tree, number);
    FlowRay& ray = rays_[index];
    ray = {};
    ray.word = logged.begin;
    ray.end = logged.end;
    ray.tree = tree;
    ray.number = number;
    ray.kind = logged.kind;
    return index;
  }

  // --- messages ---

  void send_or_set_aside(std::uint32_t from, std::uint32_t to, std::uint32_t ray, sim::Ticks now) {
    if (nodes_[to].queue.count < slots_) {
      send(from, to, ray, now, false);
      return;
    }
    if (input_.causes != nullptr) {
      input_.causes->set_aside(ray, from == from_host ? Base::host_link(cluster_of(to)) : from, now);
    }
    rays_[ray].from = from;
    rays_[ray].arrival = now;  // so rays wait in the order in which they were set aside
    ++nodes_[to].waiting.count;
    nodes_[to].waiting.insert(rays_, ray);
    if (from != from_host) {
      const std::uint32_t aside = ++nodes_[from].set_aside;
      counts_[from].most_set_aside = std::max<std::int64_t>(counts_[from].most_set_aside, aside);
    }
  }

  // Takes a slot at `to` and sends the ray there. `aside`: it was set aside.
  void send(std::uint32_t from, std::uint32_t to, std::uint32_t ray, sim::Ticks now, bool aside) {
    RayQueue& queue = nodes_[to].queue;
    counts_[to].longest_queue = std::max<std::int64_t>(counts_[to].longest_queue, ++queue.count);
    rays_[ray].arrival = from == from_host ? Base::send_camera_ray(to, ray, now, aside)
                                           : Base::send_ray(from, to, ray, now, aside);
    queue.insert(rays_, ray);
    if (nodes_[to].current == RayPool::none) {
      wake_for_first(to);
    }
  }

  void wake_for_first(std::uint32_t node) {
    const sim::Ticks arrival = rays_[nodes_[node].queue.head].arrival;
    if (arrival < nodes_[node].wake_at) {
      nodes_[node].wake_at = arrival;
      post(FlowEvent::wake, arrival, node);
    }
  }

  void wake(std::uint32_t number, sim::Ticks now) {
    Node& node = nodes_[number];
    if (node.wake_at != now) {
      return;  // outdated: another message arrived earlier and has its own event
    }
    node.wake_at = never;
    spend(number, cost::Activity::message_wait, now - cursors_[number].time);
    watch(number, walk::NodeState::message_wait, now);
    take(number, now);
  }

  // --- the nodes ---

  // A node without a ray takes the next one, if there is one.
  void next(std::uint32_t number, sim::Ticks now) {
    Node& node = nodes_[number];
    if (node.made != RayPool::none) {
      const std::uint32_t ray = node.made;
      node.made = rays_[ray].next;
      serve(number, ray);
    } else if (node.queue.head != RayPool::none) {
      if (rays_[node.queue.head].arrival <= now) {
        take(number, now);
      } else {
        wake_for_first(number);
      }
    }
  }

  // Takes the first ray of the queue. Its slot goes to the ray that has waited longest for one.
  void take(std::uint32_t number, sim::Ticks now) {
    const std::uint32_t ray = nodes_[number].queue.pop(rays_);
    if (input_.causes != nullptr) {
      input_.causes->took(number, ray, now);
    }
    FlowCounts& counts = counts_[number];
    ++counts.taken;
    counts.queued += now - rays_[ray].arrival;
    walk::Cursor& cursor = cursors_[number];
    cursor.time = sim::add_ticks(now, receive_);
    spend(number, cost::Activity::messaging, receive_);
    nodes_[number].current = ray;  // marks the node as busy, so that send() posts no wake event
    if (nodes_[number].waiting.head != RayPool::none) {
      const std::uint32_t waited = nodes_[number].waiting.pop(rays_);
      const std::uint32_t from = rays_[waited].from;
      if (from != from_host) {
        --nodes_[from].set_aside;
      }
      send(from, number, waited, now, true);
    }
    serve(number, ray);
  }

  // Begins to work on a ray at the cursor's time.
  void serve(std::uint32_t number, std::uint32_t index) {
    nodes_[number].current = index;
    FlowRay& ray = rays_[index];
    walk::Cursor& cursor = cursors_[number];
    cursor.word = ray.word;
    walker_.note_ray(cursor, trees_.ray(ray.tree, ray.number));
    cursor.word_end = last_word_here(port_of(number), ray);
    run(number);
  }

  // The end of the ray's steps at this node; also notes whether a shadow ray reaches its light.
  const std::uint32_t* last_word_here(std::uint32_t port, FlowRay& ray) const {
    const std::uint32_t* word = ray.word;
    const std::uint32_t* const end = ray.end;
    for (; word != end; word += program::step_words(word)) {
      while (program::whole_visit(*word)) {
        const std::uint32_t owner = owner_[program::operand_of(*word)];
        if ((owner != port && owner != RegionMap::top) || ++word == end) {
          return word;
        }
      }
      const std::uint32_t owner = owner_of(*word);
      if (owner != port && owner != RegionMap::top) {
        break;
      }
      ray.lit |= program::step_of(*word) == program::Step::light;
    }
    return word;
  }

  void run(std::uint32_t number) {
    walk::Cursor& cursor = cursors_[number];
    cost::NodeStatistics& statistics = statistics_[number];
    if (input_.step_by_step) {
      if (walker_.template advance<false>(number, cursor, statistics, tallies_[number]) != walk::Stop::end) {
        post(FlowEvent::step, cursor.time, number);
        return;
      }
    } else {
      (void)walker_.template advance<true>(number, cursor, statistics, tallies_[number]);
    }
    const FlowRay& ray = rays_[nodes_[number].current];
    if (cursor.word != ray.end || contributes(ray)) {
      cursor.time = sim::add_ticks(cursor.time, send_);
      spend(number, cost::Activity::messaging, send_);
    }
    post(FlowEvent::done, cursor.time, number);
    fetch_what_comes_next(number, ray);
  }

  // Prefetches into the host's caches what the node needs when it is done, while others are simulated: the
  // children of a ray that ends, the steps of the queue's first ray.
  void fetch_what_comes_next(std::uint32_t number, const FlowRay& ray) const {
    if (cursors_[number].word == ray.end) {
      sim::prefetch(trees_.ray(ray.tree, ray.number));
    }
    if (const std::uint32_t first = nodes_[number].queue.head; first != RayPool::none) {
      sim::prefetch_line(rays_[first].word);
    }
  }

  // Whether a ray adds to its pixel when it ends; a shadow ray that another ray made only does if it has
  // reached its light.
  static bool contributes(const FlowRay& ray) {
    return ray.kind != program::RayKind::shadow || ray.lit || ray.number == 0;
  }

  void done(std::uint32_t number, sim::Ticks now) {
    const std::uint32_t ray = std::exchange(nodes_[number].current, RayPool::none);
    watch_work(number, now, trees_.place(rays_[ray].tree), cursors_[number].word);
    statistics_[number].finish = now;
    end_ = std::max(end_, now);
    rays_[ray].word = cursors_[number].word;
    if (rays_[ray].word != rays_[ray].end) {
      const std::uint32_t to = number - port_of(number) + owner_of(*rays_[ray].word);
      send_or_set_aside(number, to, ray, now);
    } else {
      end_ray(number, ray, now);
    }
    next(number, now);
  }

  void end_ray(std::uint32_t number, std::uint32_t index, sim::Ticks now) {
    const FlowRay ray = rays_[index];
    rays_.give_back(index);
    ++counts_[number].ended;
    if (contributes(ray)) {
      Base::send_contribution(number, now);
    }
    const std::uint32_t cluster = cluster_of(number);
    host_.leave(cluster);
    make_rays(number, ray);
    trees_.end_ray(ray.tree);
    if (host_.has_credit(cluster)) {
      if (input_.causes != nullptr) {
        input_.causes->let_go(Base::host_link(cluster), number, now);
      }
      ask_for_rays(cluster, now);
    }
  }

  // Makes the children of `parent`, which has ended, and puts them at the head of the node's list.
  void make_rays(std::uint32_t number, const FlowRay& parent) {
    std::uint32_t last = RayPool::none;
    const std::uint32_t older = nodes_[number].made;
    for (std::uint32_t child = trees_.ray(parent.tree, parent.number).first_child;
         child != program::LoggedRay::none; child = trees_.ray(parent.tree, child).next_sibling) {
      const std::uint32_t ray = new_ray(parent.tree, child);
      trees_.begin_ray(parent.tree);
      host_.enter(cluster_of(number));
      ++counts_[number].made;
      (last == RayPool::none ? nodes_[number].made : rays_[last].next) = ray;
      last = ray;
    }
    if (last != RayPool::none) {
      rays_[last].next = older;
    }
  }

  const SpacePlan& plan_;
  const std::uint32_t* owner_;
  walk::LogWalker<Caches> walker_;
  RayPool rays_;
  PixelTrees trees_;
  sim::LargeVector<Node> nodes_;
  sim::LargeVector<walk::Cursor> cursors_;
  std::vector<Admission> admissions_;
  std::uint32_t slots_;
  sim::Ticks send_;
  sim::Ticks receive_;
};

}  // namespace marti::processors::flow
