// The work inside a pipeline node: it takes those steps of the ray in service that belong to its stage.
#pragma once

#include <utility>

#include "processors/flow/pipeline/pipeline_core.h"
#include "processors/flow/pipeline/staged_walker.h"
#include "sim/prefetch.h"

namespace marti::processors {

/// `Caches` is one of node_caches.h, or CountedCaches.
template <class Caches>
class PipelineNodes final : public PipelineCore {
 public:
  PipelineNodes(const FlowParts& parts, Caches caches)
      : PipelineCore(parts),
        walker_(parts.input, std::move(caches)),
        cursors_(parts.input.config.all_nodes()),
        receive_(parts.input.config.clock.cycles(parts.input.config.messages.receive_cycles)) {}

  void read_done(std::uint32_t node, const memory::Service& service) override {
    spend(node, service);
    watch_read(node, service, place_of(node));
    Cursor& cursor = cursors_[node];
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

  void finish() override {
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
      finish_node(node, walker_.ticks());
    }
  }

  SecondLevelResult second_level() const override { return walker_.behind().second_level().result(); }

  CacheCountResult cache_counts() const override { return walker_.counts(); }

  std::size_t bytes_per_node() const override {
    return sizeof(Cursor) + sizeof(Node) + sizeof(NodeStatistics) + sizeof(FlowCounts) +
           2 * sizeof(sim::Event);
  }

 private:
  void begin(std::uint32_t node, FlowRay& ray) override {
    Cursor& cursor = cursors_[node];
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
        walker_.begin_objects(cursor, statistics_[node]);
        cursor.word_end = cursor.word;
        ray.record_read = false;
        break;
      case Stage::shade:
        cursor.word_end = end_of_shading(ray);
        break;
    }
  }

  void work(std::uint32_t node) override {
    Cursor& cursor = cursors_[node];
    NodeStatistics& statistics = statistics_[node];
    for (;;) {
      const Stop stop = input_.step_by_step ? walker_.template advance<false>(node, cursor, statistics)
                                            : walker_.template advance<true>(node, cursor, statistics);
      if (stop != Stop::end) {
        post(stop == Stop::hit ? FlowEvent::step : FlowEvent::read, cursor.time, node);
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

  void read(std::uint32_t node) override {
    const Cursor& cursor = cursors_[node];
    watch_ray(node, cursor.time, cursor.word);
    interconnect_of(node).read({port_of(node), walker_.missed_address(cursor), walker_.missed_bytes(cursor)});
  }

  // Begins to read the record of the leaf at which the steps of `search` end; false if they end elsewhere.
  bool begin_record(Cursor& cursor, std::uint32_t node, FlowRay& ray) {
    if (cursor.word == ray.end || !visits_leaf(cursor.word)) {
      return false;
    }
    walker_.begin_record(cursor, statistics_[node]);
    ray.record_read = true;
    return true;
  }

  // The first step that `search` leaves to others, or a leaf with entries, whose record alone it reads.
  const std::uint32_t* end_of_search(const FlowRay& ray) const {
    const std::uint32_t* word = ray.word;
    const accel::Topology& topology = input_.log.topology;
    for (; word != ray.end; word += step_words(word)) {
      // Most steps are branches.
      if (step_of(*word) != Step::branch &&
          (stage_of(word) != Stage::search || (visits_leaf(word) && entries_read(word, topology) != 0))) {
        break;
      }
    }
    return word;
  }

  static const std::uint32_t* end_of_shading(FlowRay& ray) {
    const std::uint32_t* word = ray.word;
    while (word != ray.end && stage_of(word) == Stage::shade) {
      ray.lit = ray.lit || step_of(*word) == Step::light;
      word += step_words(word);
    }
    return word;
  }

  StagedWalker<Caches> walker_;
  sim::LargeVector<Cursor> cursors_;
  sim::Ticks receive_;
};

}  // namespace marti::processors
