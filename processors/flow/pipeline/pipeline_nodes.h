// The work inside a pipeline node: it takes those steps of the ray in service that belong to its stage.
#pragma once

#include <utility>

#include "processors/flow/pipeline/pipeline_core.h"
#include "processors/flow/pipeline/staged_walker.h"
#include "sim/prefetch.h"

namespace marti::processors::flow {

/// `Caches` is one of node_caches.h, or CountedCaches.
template <class Caches>
class PipelineNodes final : public PipelineCore {
 public:
  PipelineNodes(const FlowParts& parts, Caches caches)
      : PipelineCore(parts),
        walker_(parts.input, std::move(caches)),
        cursors_(parts.input.config.all_nodes()),
        receive_(parts.input.config.clock.cycles(parts.input.config.messages.receive_cycles)) {}

  void handle(const sim::Event& event) override {
    const std::uint32_t component = event.component();
    switch (static_cast<FlowEvent>(event.event_class())) {
      case FlowEvent::step:
        work(component);
        break;
      case FlowEvent::reply:
        reply(component);
        break;
      case FlowEvent::read:
        read(component);
        break;
      case FlowEvent::done:
        done(component, event.time);
        break;
      case FlowEvent::wake:
        wake(component, event.time);
        break;
      case FlowEvent::admit:
        admit(component, event.time);
        break;
      case FlowEvent::memory:
        interconnect_of(component).proceed(port_of(component), event.sequence());
        break;
    }
  }
  // Only the events of data that are ready are posted in order.
  void handle_in_order(const sim::Event& event) {
    sim::ensure(event.event_class() == static_cast<std::uint8_t>(FlowEvent::reply),
                "an event that is no reply was posted in order");
    reply(event.component());
  }

  void run_all(sim::Engine& engine) override { engine.run_all(*this); }

  void read_done(std::uint32_t node, const memory::Service& service) override {
    spend(node, service);
    if (input_.observer != nullptr) [[unlikely]] {
      watch_read(node, service, place_of(node));
    }
    walk::Cursor& cursor = cursors_[node];
    cursor.time = service.done;
    walker_.note_wait(cursor, service);
    walker_.pass(cursor);
    work(node);
  }

  void prepare(const sim::Event& event) override {
    const std::uint32_t node = event.component();
    if (node < nodes_.size()) {
      sim::prefetch(nodes_[node]);
      sim::prefetch(cursors_[node]);
      sim::prefetch(statistics_[node]);
      sim::prefetch(counts_[node]);
    }
  }

  void settle() override {
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      walker_.flush(tallies_[node], statistics_[node]);
    }
  }

  void finish() override {
    end_nodes();
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      finish_node(node, walker_);
    }
  }

  walk::SecondLevelResult second_level() const override { return walker_.behind().second_level().result(); }

  walk::CacheCountResult cache_counts() const override { return walker_.counts(); }

  std::size_t bytes_per_node() const override {
    return sizeof(walk::Cursor) + sizeof(Node) + sizeof(cost::NodeStatistics) + sizeof(FlowCounts) +
           sizeof(walk::VisitTally) + 2 * sizeof(sim::Event);
  }

 private:
  void serve(std::uint32_t node, FlowRay& ray) override {
    walk::Cursor& cursor = cursors_[node];
    cursor.time = sim::add_ticks(engine_.now(), receive_);
    cursor.word = ray.word;
    walker_.note_ray(cursor, logged(ray));
    switch (nodes_[node].stage) {
      case Stage::search:
        cursor.word_end = end_of_search(ray);
        if (cursor.word == cursor.word_end) {
          begin_record(cursor, node, ray);
        }
        break;
      case Stage::nearest:
        walker_.begin_objects(cursor, statistics_[node], tallies_[node]);
        cursor.word_end = cursor.word;
        ray.record_read = false;
        break;
      case Stage::shade:
        cursor.word_end = end_of_shading(ray);
        break;
    }
    work(node);
  }

  void work(std::uint32_t node) {
    walk::Cursor& cursor = cursors_[node];
    cost::NodeStatistics& statistics = statistics_[node];
    walk::VisitTally& tally = tallies_[node];
    for (;;) {
      const walk::Stop stop = input_.step_by_step
                                  ? walker_.template advance<false>(node, cursor, statistics, tally)
                                  : walker_.template advance<true>(node, cursor, statistics, tally);
      if (stop != walk::Stop::end) {
        post(stop == walk::Stop::hit ? FlowEvent::step : FlowEvent::read, cursor.time, node);
        return;
      }
      FlowRay& ray = ray_of(node);
      if (nodes_[node].stage == Stage::search && !ray.record_read && begin_record(cursor, node, ray)) {
        continue;
      }
      ray.word = cursor.word;
      worked(node, ray, cursor.time);
      return;
    }
  }

  void read(std::uint32_t node) {
    const walk::Cursor& cursor = cursors_[node];
    if (input_.observer != nullptr) [[unlikely]] {
      watch_ray(node, cursor.time, cursor.word);
    }
    read_memory(node, walker_.missed_address(cursor), walker_.missed_bytes(cursor));
  }

  // Begins to read the record of the leaf at which the steps of `search` end; false if they end elsewhere.
  bool begin_record(walk::Cursor& cursor, std::uint32_t node, FlowRay& ray) {
    if (cursor.word == ray.end || !visits_leaf(cursor.word)) {
      return false;
    }
    walker_.begin_record(cursor, statistics_[node]);
    ray.record_read = true;
    return true;
  }

  // The first step that `search` leaves to others, or a leaf with entries, whose record alone it reads.
  const std::uint32_t* end_of_search(const FlowRay& ray) const {
    const accel::Topology& topology = input_.log.topology;
    const std::uint32_t* word = ray.word;
    for (; word != ray.end; word += program::step_words(word)) {
      // Nearly all steps are branches and leaves.
      while (program::whole_visit(*word)) {
        if (program::step_of(*word) == program::Step::leaf && walker_.has_objects(*word)) {
          return word;
        }
        if (++word == ray.end) {
          return word;
        }
      }
      if (stage_of(word) != Stage::search || (visits_leaf(word) && entries_read(word, topology) != 0)) {
        break;
      }
    }
    return word;
  }

  static const std::uint32_t* end_of_shading(FlowRay& ray) {
    const std::uint32_t* word = ray.word;
    while (word != ray.end && stage_of(word) == Stage::shade) {
      ray.lit = ray.lit || program::step_of(*word) == program::Step::light;
      word += program::step_words(word);
    }
    return word;
  }

  StagedWalker<Caches> walker_;
  sim::LargeVector<walk::Cursor> cursors_;
  sim::Ticks receive_;
};

}  // namespace marti::processors::flow
