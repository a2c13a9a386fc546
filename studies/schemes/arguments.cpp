#include "studies/schemes/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "studies/tables/text_units.h"

namespace marti::studies::schemes {

namespace {

using processors::machine::Scheme;

// A machine must be timed with at least so many numbers of nodes to say anything about growth.
constexpr std::size_t fewest_points = 3;

enum class Kind { naive, cached, space };

bool is(Kind kind, const ScalingPoint& point) {
  switch (kind) {
    case Kind::naive:
      return point.scheme == Scheme::image && point.hit_ratio.value_or(0.0) == 0.0;
    case Kind::cached:
      return point.scheme == Scheme::image && point.hit_ratio.value_or(0.0) > 0.0 && point.interconnect;
    case Kind::space:
      return point.scheme == Scheme::space;
  }
  return false;
}

// The points of the first machine of that kind; empty when it is missing or was timed too few times.
std::vector<ScalingPoint> find(Kind kind, std::span<const ScalingPoint> points) {
  const auto first = std::ranges::find_if(points, [&](const auto& p) { return is(kind, p); });
  if (first == points.end()) {
    return {};
  }
  std::vector<ScalingPoint> found = points_of(points, first->machine);
  return found.size() >= fewest_points ? found : std::vector<ScalingPoint>{};
}

double efficiency(const ScalingPoint& point) { return point.efficiency.value_or(0.0); }
double speed_up(const ScalingPoint& point) { return point.speed_up.value_or(0.0); }

tables::Claim naive(std::span<const ScalingPoint> points) {
  tables::Claim claim{"naive pixel parallelism", "one shared memory saturates with few processors", "", {}};
  claim.verdict = tables::Verdict::not_measured;
  if (const std::vector<ScalingPoint> machine = find(Kind::naive, points); !machine.empty()) {
    const auto best = std::ranges::max_element(
        machine, [](const auto& a, const auto& b) { return speed_up(a) < speed_up(b); });
    const ScalingPoint& last = machine.back();
    claim.here = fmt::format(
        "at most {} times as fast as one node, and with {} nodes the way to memory is {:.1f} % busy",
        tables::times(speed_up(*best)), last.nodes, 100.0 * last.interconnect.value_or(0.0));
    claim.verdict = tables::verdict_of(last.interconnect.value_or(0.0) > 0.9 && efficiency(last) < 0.5);
  }
  return claim;
}

// "12", "4.4" below 10, or "more than 64" where that many do not suffice.
std::string nodes_text(const std::optional<double>& nodes, std::span<const ScalingPoint> machine) {
  return nodes ? fmt::format("{:.{}f}", *nodes, *nodes < 10.0 ? 1 : 0)
               : fmt::format("more than {}", machine.back().nodes);
}

tables::Claim cached(std::span<const ScalingPoint> points) {
  tables::Claim claim{
      "packets with private caches", "a much larger number of processors can share the memory", "", {}};
  claim.verdict = tables::Verdict::not_measured;
  const std::vector<ScalingPoint> without = find(Kind::naive, points);
  std::vector<ScalingPoint> with = find(Kind::cached, points);
  if (!without.empty() && !with.empty()) {
    // Nodes that get fewer packets than others wait for these, not for the memory.
    std::erase_if(with, [](const auto& point) { return point.limit == figures::Limit::imbalance; });
    const std::optional<double> few = half_efficiency_nodes(without);
    const std::optional<double> many = half_efficiency_nodes(with);
    if (with.empty()) {
      return claim;
    }
    claim.here = fmt::format("half the efficiency is left at {} nodes, without caches at {}",
                             nodes_text(many, with), nodes_text(few, without));
    // Where the measured machines have too few nodes to tell, nothing is said.
    if (few && (many || with.back().nodes >= 4.0 * *few)) {
      claim.verdict = tables::verdict_of(!many || *many >= 4.0 * *few);
    }
  }
  return claim;
}

tables::Claim space(std::span<const ScalingPoint> points) {
  constexpr double most_nodes = 40.0;  // "ten or twenty", generously
  tables::Claim claim{"space parallelism", "efficiency falls beyond ten or twenty processors", "", {}};
  claim.verdict = tables::Verdict::not_measured;
  if (const std::vector<ScalingPoint> machine = find(Kind::space, points); !machine.empty()) {
    std::string figures;
    for (const ScalingPoint& point : machine) {
      figures += fmt::format("{}{} at {}", figures.empty() ? "" : ", ",
                             fmt::format("{:.2f}", efficiency(point)), point.nodes);
    }
    const std::optional<double> half = half_efficiency_nodes(machine);
    claim.here = fmt::format("efficiency {} nodes; one half at {}", figures, nodes_text(half, machine));
    if (half || machine.back().nodes >= most_nodes) {
      claim.verdict = tables::verdict_of(half && *half <= most_nodes);
    }
  }
  return claim;
}

tables::Claim pipeline(std::span<const StagePoint> stages) {
  tables::Claim claim{"pipelining", "the slowest stage limits the machine", "",
                      tables::Verdict::not_measured};
  if (stages.size() > 1) {
    const StagePoint& first = stages.front();
    const auto best = std::ranges::min_element(stages, {}, &StagePoint::end);
    const auto describe = [](const StagePoint& point) {
      return fmt::format("{} + {} + {} nodes: {} {:.0f} % busy", point.nodes[0], point.nodes[1],
                         point.nodes[2], stage_names[point.slowest()], 100.0 * point.busy[point.slowest()]);
    };
    claim.here = fmt::format("{}; {}, {} times as fast", describe(first), describe(*best),
                             tables::times(static_cast<double>(first.end) / static_cast<double>(best->end)));
    // Nodes taken from the least busy stage and given to the busiest must help.
    claim.verdict = tables::verdict_of(first.busy[first.slowest()] > 0.8 && best->end < first.end);
  }
  return claim;
}

tables::Claim cells(std::span<const CellPoint> points) {
  tables::Claim claim{"size of the cells", "too small and too large cells both hurt the cache", "",
                      tables::Verdict::not_measured};
  const auto misses = [](const CellPoint& point) { return point.tree.references.all_misses(); };
  const auto by_misses = std::ranges::minmax_element(points, {}, misses);
  // Trees that are alike, and a machine without a cache, say nothing.
  if (points.size() >= fewest_points && misses(*by_misses.min) < misses(*by_misses.max) &&
      points.front().tree.references.all_hits() > 0) {
    const CellPoint& fewest = *by_misses.min;
    claim.here = fmt::format("fewest misses with level {}", fewest.level);
    bool both_hurt = true;
    for (const CellPoint* const end : {&points.front(), &points.back()}) {
      const double times =
          static_cast<double>(misses(*end)) / static_cast<double>(std::max<std::int64_t>(1, misses(fewest)));
      both_hurt = both_hurt && times > 1.05;
      claim.here += end == &fewest
                        ? ", the last tried on that side"
                        : fmt::format("; {} times as many with {}", tables::times(times), end->level);
    }
    claim.verdict = tables::verdict_of(both_hurt);
  }
  return claim;
}

}  // namespace

std::optional<double> half_efficiency_nodes(std::span<const ScalingPoint> machine) {
  constexpr double half = 0.5;
  double before = 1.0;  // of one node, be it timed or not
  double from = 0.0;    // log2(1)
  for (const ScalingPoint& point : machine) {
    const double after = efficiency(point);
    const double to = std::log2(point.nodes);
    if (after < half) {
      return std::exp2(from + (to - from) * (before - half) / (before - after));
    }
    before = after;
    from = to;
  }
  return std::nullopt;
}

std::vector<tables::Claim> check_arguments(std::span<const ScalingPoint> points,
                                           std::span<const CellPoint> cell_points,
                                           std::span<const StagePoint> stages) {
  return {naive(points), cached(points), space(points), pipeline(stages), cells(cell_points)};
}

}  // namespace marti::studies::schemes
