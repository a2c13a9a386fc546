#include "processors/walk/visit_plan.h"

#include "processors/walk/node_order.h"
#include "sim/error.h"

namespace marti::processors::walk {

namespace {

using memory::RecordKind;

VisitCount test_count(accel::PrimitiveKind kind) {
  switch (kind) {
    case accel::PrimitiveKind::triangle:
      return VisitCount::test;
    case accel::PrimitiveKind::sphere:
      return VisitCount::sphere_test;
    case accel::PrimitiveKind::cone:
      return VisitCount::cone_test;
  }
  throw sim::InternalError("a visit tests a primitive of an unknown kind");
}

// Collects the lines of visits, one visit after the other.
class Planner {
 public:
  Planner(const memory::Layout& layout, unsigned line_shift, const cost::StepTicks& ticks, VisitPlan& plan)
      : layout_(layout), line_shift_(line_shift), ticks_(ticks), plan_(plan) {}

  void begin() {
    begin_ = plan_.lines.size();
    counts_ = {};
    fits_ = true;
  }

  void count(VisitCount what) {
    fits_ = fits_ && counts_.of(what) < most_of_a_count;
    if (fits_) {
      counts_.add(what);
    }
  }

  // Reads records `first` to `first + records - 1` of a section in one go.
  void read(RecordKind kind, std::uint64_t first, std::uint64_t records, VisitCount lines) {
    const memory::Address begin = layout_.address(kind, first);
    const memory::Address last = begin + records * layout_.record_bytes(kind, first) - 1;
    const std::uint32_t label = (static_cast<std::uint32_t>(kind) << label_bits) |
                                counts_.of(VisitCount::test) | (counts_.of(VisitCount::sphere_test) << 8U) |
                                (counts_.of(VisitCount::cone_test) << 16U);
    for (memory::Address line = begin >> line_shift_; line <= last >> line_shift_ && fits(); ++line) {
      plan_.lines.push_back(static_cast<std::uint32_t>(line));
      plan_.labels.push_back(label);
      count(lines);
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
    // A visit whose time overflows may never be made, so it must not stop the run.
    const auto fits = [&](sim::Ticks each, std::int64_t count) {
      sim::Ticks time = 0;
      return !__builtin_mul_overflow(each, count, &time) &&
             !__builtin_add_overflow(visit.time, time, &visit.time);
    };
    const std::int64_t tests = std::int64_t{counts_.of(VisitCount::test)} +
                               counts_.of(VisitCount::sphere_test) + counts_.of(VisitCount::cone_test);
    if (!fits(counts_.of(VisitCount::leaf) != 0 ? ticks_.leaf : ticks_.branch, 1) ||
        !fits(ticks_.lookup, tests) || !fits(ticks_.test, counts_.of(VisitCount::test)) ||
        !fits(ticks_.sphere_test, counts_.of(VisitCount::sphere_test)) ||
        !fits(ticks_.cone_test, counts_.of(VisitCount::cone_test)) || !fits(ticks_.hit, visit.lines)) {
      visit.lines = 0;
    }
  }

 private:
  const memory::Layout& layout_;
  unsigned line_shift_;
  const cost::StepTicks& ticks_;
  VisitPlan& plan_;
  std::size_t begin_ = 0;
  VisitCounts counts_;
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
    planner.begin();
    if (node.leaf) {
      planner.count(VisitCount::leaf);
    }
    if (const std::uint32_t record = rank.empty() ? number : rank[number]; record != no_record) {
      planner.read(RecordKind::node, record, 1, VisitCount::node_line);
    }
    if (node.leaf && node.count != 0) {
      planner.count(VisitCount::list);
      planner.read(RecordKind::list, node.first, node.count, VisitCount::list_line);
      for (std::uint32_t entry = 0; entry < node.count && planner.fits(); ++entry) {
        const std::uint32_t primitive = topology.entries[node.first + entry];
        planner.count(test_count(log.kind_of(primitive)));
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
