#include "processors/walk/visit_plan.h"

#include "accel/quadric_shape.h"
#include "processors/walk/node_order.h"
#include "sim/error.h"

namespace marti::processors::walk {

namespace {

using memory::RecordKind;

// Collects the lines of visits, one visit after the other.
class Planner {
 public:
  Planner(const memory::Layout& layout, unsigned line_shift, const cost::StepTicks& ticks, VisitPlan& plan)
      : layout_(layout), line_shift_(line_shift), ticks_(ticks), plan_(plan) {}

  void begin(bool leaf) {
    begin_ = plan_.lines.size();
    counts_ = {};
    fits_ = true;
    time_ = 0;
    if (leaf) {
      count(VisitCount::leaf, ticks_.leaf);
    } else {
      spend(ticks_.branch);
    }
  }

  // `time`: what one takes.
  void count(VisitCount what, sim::Ticks time) {
    fits_ = fits_ && counts_.of(what) < most_of_a_count;
    if (fits_) {
      counts_.add(what);
      spend(time);
    }
  }

  void test(accel::PrimitiveKind kind) {
    spend(ticks_.lookup);
    switch (kind) {
      case accel::PrimitiveKind::triangle:
        return count(VisitCount::test, ticks_.test);
      case accel::PrimitiveKind::sphere:
        return count(VisitCount::sphere_test, ticks_.sphere_test);
      case accel::PrimitiveKind::cone:
        return count(VisitCount::cone_test, ticks_.cone_test);
    }
    throw sim::InternalError("a visit tests a primitive of an unknown kind");
  }

  // Reads records `first` to `first + records - 1` of a section in one go.
  void read(RecordKind kind, std::uint64_t first, std::uint64_t records, VisitCount lines) {
    const memory::Address begin = layout_.address(kind, first);
    const memory::Address last = begin + records * layout_.record_bytes(kind, first) - 1;
    for (memory::Address line = begin >> line_shift_; line <= last >> line_shift_ && fits(); ++line) {
      plan_.lines.push_back(static_cast<std::uint32_t>(line));
      plan_.labels.push_back(static_cast<std::uint64_t>(kind) << label_bits |
                             static_cast<std::uint64_t>(time_));
      count(lines, ticks_.hit);
    }
  }

  [[nodiscard]] bool fits() const { return fits_; }

  void end() {
    Visit& visit = plan_.visits.emplace_back();
    if (!fits_) {
      plan_.lines.resize(begin_);
      plan_.labels.resize(begin_);
      return;
    }
    visit.begin = static_cast<std::uint32_t>(begin_);
    visit.lines = static_cast<std::uint32_t>(plan_.lines.size() - begin_);
    visit.counts = counts_;
    visit.time = time_;
  }

 private:
  static constexpr sim::Ticks most_time = (sim::Ticks{1} << label_bits) - 1;

  // A visit that takes too long may never be made, so it must not stop the run.
  void spend(sim::Ticks time) {
    fits_ = fits_ && time <= most_time - time_;
    time_ += fits_ ? time : 0;
  }

  const memory::Layout& layout_;
  unsigned line_shift_;
  const cost::StepTicks& ticks_;
  VisitPlan& plan_;
  std::size_t begin_ = 0;
  VisitCounts counts_;
  sim::Ticks time_ = 0;
  bool fits_ = true;
};

}  // namespace

VisitPlan plan_visits(const program::WorkLog& log, const memory::Layout& layout,
                      std::span<const std::uint32_t> rank, unsigned line_shift,
                      const cost::StepTicks& ticks) {
  const accel::Topology& topology = log.topology;
  VisitPlan plan;
  plan.visits.reserve(topology.nodes.size());
  Planner planner(layout, line_shift, ticks, plan);
  for (std::uint32_t number = 0; number < topology.nodes.size(); ++number) {
    const accel::TopologyNode& node = topology.nodes[number];
    if (node.instance) {  // taken record by record
      plan.visits.emplace_back();
      continue;
    }
    planner.begin(node.leaf);
    if (const std::uint32_t record = rank.empty() ? number : rank[number]; record != no_record) {
      planner.read(RecordKind::node, record, 1, VisitCount::node_line);
    }
    if (node.leaf && node.count != 0) {
      planner.count(VisitCount::list, 0);
      planner.read(RecordKind::list, node.first, node.count, VisitCount::list_line);
      for (std::uint32_t entry = 0; entry < node.count && planner.fits(); ++entry) {
        const std::uint32_t primitive = topology.entries[node.first + entry];
        planner.test(log.kind_of(primitive));
        planner.read(RecordKind::primitive, primitive, 1, VisitCount::primitive_line);
      }
    }
    planner.end();
    if (plan.lines.size() > most_planned_lines) {
      return {};
    }
  }
  return plan;
}

void add_visits(const VisitCounts& counts, std::uint32_t visits, bool mailboxes,
                cost::NodeStatistics& statistics) {
  const auto of = [&](VisitCount what) { return std::int64_t{counts.of(what)}; };
  const auto add_hits = [&](memory::RecordKind kind, VisitCount what) {
    statistics.references.hits[static_cast<std::size_t>(kind)] += of(what);
  };
  const std::int64_t tests = of(VisitCount::test) + of(VisitCount::sphere_test) + of(VisitCount::cone_test);
  cost::StepCounts& steps = statistics.steps;
  steps.branches += visits - of(VisitCount::leaf);
  steps.leaves += of(VisitCount::leaf);
  steps.lists += of(VisitCount::list);
  steps.tests += tests;
  steps.lookups += mailboxes ? tests : 0;
  steps.sphere_tests += of(VisitCount::sphere_test);
  steps.cone_tests += of(VisitCount::cone_test);
  add_hits(memory::RecordKind::node, VisitCount::node_line);
  add_hits(memory::RecordKind::list, VisitCount::list_line);
  add_hits(memory::RecordKind::primitive, VisitCount::primitive_line);
}

}  // namespace marti::processors::walk
