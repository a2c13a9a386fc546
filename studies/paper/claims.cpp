#include "studies/paper/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "processors/cost/operation_mix.h"
#include "sim/error.h"
#include "studies/tables/text_units.h"

namespace marti::studies::paper {

namespace {

// The paper's second teapot, on which most of its statements rest.
constexpr std::string_view pot = "teapot:12:pot";
// The scene that stands in for the paper's largest, of about 19,000 polygons, on which its savings rest.
constexpr std::string_view large = "large";

const SceneTrees* find(std::span<const SceneTrees> scenes, std::string_view name) {
  const auto at = std::ranges::find(scenes, name, &SceneTrees::scene);
  return at == scenes.end() ? nullptr : &*at;
}

tables::Claim polygons(std::span<const SceneTrees> scenes, std::string_view name, std::uint64_t published) {
  tables::Claim claim{fmt::format("size of {}", name), fmt::format("{} polygons", published), "", {}};
  claim.verdict = tables::Verdict::not_measured;
  if (const SceneTrees* scene = find(scenes, name)) {
    // The pot's polygons are its triangles; other scenes keep the count of their source.
    const std::uint64_t here = name.starts_with("teapot") ? scene->primitives : scene->polygons;
    claim.here = fmt::format("{}", here);
    claim.verdict = tables::verdict_of(here == published);
  }
  return claim;
}

/// Share of what lies on level `first` and deeper.
template <class Count>
double deep_share(std::size_t levels, std::size_t first, const Count& count) {
  std::uint64_t deep = 0;
  std::uint64_t all = 0;
  for (std::size_t level = 1; level <= levels; ++level) {
    all += count(level);
    deep += level >= first ? count(level) : 0;
  }
  return all == 0 ? 0.0 : static_cast<double>(deep) / static_cast<double>(all);
}

std::string level_text(const std::optional<std::uint32_t>& level) {
  return level ? fmt::format("level {}", *level) : "no level";
}

tables::Claim deep_nodes(std::span<const SceneTrees> scenes) {
  tables::Claim claim{"nodes of the teapot's octree", "42 % lie in levels 8 to 12", "",
                      tables::Verdict::not_measured};
  if (const SceneTrees* scene = find(scenes, pot); scene != nullptr && scene->octree.levels.size() >= 8) {
    const std::vector<LevelCount>& levels = scene->octree.levels;
    const double share = deep_share(levels.size(), 8, [&](std::size_t l) { return levels[l - 1].nodes(); });
    claim.here =
        fmt::format("{:.2f} %; 9 objects a leaf, the default, were fitted to the 42 %", 100.0 * share);
    claim.verdict = tables::verdict_of(std::abs(share - 0.42) <= 0.005);
  }
  return claim;
}

tables::Claim first_level(std::span<const SceneTrees> scenes, std::string_view name, double k,
                          std::uint32_t published) {
  tables::Claim claim{
      fmt::format("leaves against other nodes, {}", name == pot ? "teapot" : "19,000 polygons"),
      fmt::format("more than {:g} times as many first on level {}", k, published), "",
      tables::Verdict::not_measured};
  if (const SceneTrees* scene = find(scenes, name);
      scene != nullptr && scene->octree.levels.size() >= published) {
    const std::optional<std::uint32_t> level = rule_level(scene->octree.levels, k);
    claim.here = level_text(level);
    claim.verdict = tables::verdict_of(level == published);
  }
  return claim;
}

tables::Claim bsp_leaves(std::span<const SceneTrees> scenes) {
  tables::Claim claim{"BSP tree against octree", "the BSP tree has fewer leaves", "",
                      tables::Verdict::not_measured};
  bool always = true;
  for (const SceneTrees& scene : scenes) {
    const std::uint64_t bsp = scene.bsp.total().leaves;
    const std::uint64_t octree = scene.octree.total().leaves;
    always = always && bsp < octree;
    claim.here +=
        (claim.here.empty() ? "" : "; ") + fmt::format("{} {} against {}", scene.scene, bsp, octree);
  }
  if (!scenes.empty()) {
    claim.verdict = tables::verdict_of(always);
  }
  return claim;
}

/// Numbers of nodes are very similar when they differ by at most this share.
constexpr double very_similar = 0.1;

tables::Claim node_counts(std::span<const SceneTrees> scenes) {
  tables::Claim claim{"BSP tree against octree", "very similar numbers of nodes", "",
                      tables::Verdict::not_measured};
  bool always = true;
  for (const SceneTrees& scene : scenes) {
    const double ratio =
        static_cast<double>(scene.bsp.total().nodes()) / static_cast<double>(scene.octree.total().nodes());
    always = always && std::abs(ratio - 1.0) <= very_similar;
    claim.here += (claim.here.empty() ? "" : "; ") + fmt::format("{} {:.2f} of them", scene.scene, ratio);
  }
  if (!scenes.empty()) {
    claim.verdict = tables::verdict_of(always);
  }
  return claim;
}

const TracedRun* find_pot(std::span<const TracedRun> runs) {
  const auto at = std::ranges::find_if(runs, [](const auto& r) { return r.run.scene == pot; });
  return at == runs.end() ? nullptr : &*at;
}

std::uint64_t accesses(const TracedRun& run, std::size_t level) {
  return level <= run.visits.per_level.size() ? run.visits.per_level[level - 1] : 0;
}

tables::Claim deep_accesses(const TracedRun* run) {
  tables::Claim claim{"accesses to deep levels, teapot", "less than 1 % go to levels 8 to 12", "",
                      tables::Verdict::not_measured};
  if (run != nullptr && run->visits.per_level.size() >= 8) {
    const std::size_t levels = run->visits.per_level.size();
    const auto of_level = [&](std::size_t level) { return accesses(*run, level); };
    const double share = deep_share(levels, 8, of_level);
    const double deeper = deep_share(levels, 9, of_level);
    claim.here = fmt::format("{:.2f} %; levels 9 to 12 {:.2f} %", 100.0 * share, 100.0 * deeper);
    claim.verdict = tables::verdict_of(share < 0.01);
  }
  return claim;
}

tables::Claim access_fall(const TracedRun* run) {
  tables::Claim claim{"accesses by level, teapot", "they fall steeply beyond level 8", "",
                      tables::Verdict::not_measured};
  if (run != nullptr && accesses(*run, 8) != 0) {
    const auto peak = std::ranges::max_element(run->visits.per_level);
    const double left = static_cast<double>(accesses(*run, 9)) / static_cast<double>(accesses(*run, 8));
    claim.here = fmt::format("most on level {}; level 9 has {:.1f} % of the accesses of level 8",
                             peak - run->visits.per_level.begin() + 1, 100.0 * left);
    claim.verdict = tables::verdict_of(left < 0.5);
  }
  return claim;
}

tables::Claim access_drop(const TracedRun* run) {
  tables::Claim claim{"accesses by level, teapot", "they drop after level 5", "",
                      tables::Verdict::not_measured};
  if (run != nullptr && accesses(*run, 5) != 0) {
    bool drop = true;
    for (std::size_t level = 5; level < run->visits.per_level.size(); ++level) {
      drop = drop && accesses(*run, level + 1) <= accesses(*run, level);
    }
    const double left = static_cast<double>(accesses(*run, 6)) / static_cast<double>(accesses(*run, 5));
    claim.here = fmt::format(
        "level 6 has {:.1f} % of the accesses of level 5, and {} level below it more than the one above",
        100.0 * left, drop ? "no" : "some");
    claim.verdict = tables::verdict_of(drop && left < 1.0);
  }
  return claim;
}

/// Arithmetic, comparisons and operations on integers of a frame of triangles, by the mean of each step.
double operations(const TracedRun& run) {
  const processors::cost::OperationMixes& mixes = processors::cost::operation_mixes(run.log->traversal);
  const processors::program::LogTotals& steps = run.totals;
  double thousandths = 0.0;
  const auto add = [&](std::uint64_t count, const processors::cost::OperationMix& mix) {
    thousandths +=
        static_cast<double>(count) * static_cast<double>(mix.add + mix.multiply + mix.divide +
                                                         mix.square_root + mix.compare + mix.integer);
  };
  for (std::size_t kind = 0; kind < processors::program::ray_kinds; ++kind) {
    add(steps.rays[kind], mixes.ray[kind]);
  }
  add(steps.branches, mixes.branch);
  add(steps.leaves, mixes.leaf);
  add(steps.tests, mixes.test);
  add(steps.shades, mixes.shade);
  add(steps.lights, mixes.light);
  add(std::uint64_t{run.log->width} * run.log->height, mixes.pixel);
  return thousandths / 1000.0;
}

/// The paper does not name the scene; the claim agrees when the second teapot takes within a quarter of the
/// paper's number.
tables::Claim frame_operations(std::span<const TracedRun> runs) {
  constexpr double published = 900e6;
  constexpr double pixels = 1024.0 * 1024.0;
  tables::Claim claim{"operations of a 1024 x 1024 frame", "about 900 million", "",
                      tables::Verdict::not_measured};
  for (const TracedRun& run : runs) {
    const double scaled = operations(run) * pixels / (static_cast<double>(run.log->width) * run.log->height);
    claim.here +=
        (claim.here.empty() ? "" : "; ") + fmt::format("{}: {:.0f} million", name_of(run.run), scaled / 1e6);
    if (&run == find_pot(runs)) {
      claim.verdict = tables::verdict_of(std::abs(scaled / published - 1.0) <= 0.25);
    }
  }
  return claim;
}

/// First level that has more accesses than the next.
std::uint32_t last_rise(const TracedRun& run) {
  std::size_t level = 1;
  while (accesses(run, level + 1) >= accesses(run, level) && level < run.visits.per_level.size()) {
    ++level;
  }
  return static_cast<std::uint32_t>(level);
}

tables::Claim worst_case(std::span<const TracedRun> runs) {
  tables::Claim claim{
      "where accesses begin to fall",
      "at the latest below the level on which L > 3 (B + P), if a ray enters at most four children", "",
      tables::Verdict::not_measured};
  bool always = true;
  for (const TracedRun& run : runs) {
    const std::uint32_t fall = last_rise(run);
    const std::uint32_t bound =
        rule_level(run.levels, 3.0).value_or(static_cast<std::uint32_t>(run.levels.size()));
    always = always && fall <= bound;
    claim.here += (claim.here.empty() ? "" : "; ") +
                  fmt::format("{}: below level {}, rule at {}", name_of(run.run), fall, bound);
  }
  if (!runs.empty()) {
    claim.verdict = tables::verdict_of(always);
  }
  return claim;
}

}  // namespace

std::vector<tables::Claim> check_tree_claims(std::span<const SceneTrees> scenes) {
  return {polygons(scenes, "gears:2", 1169),
          polygons(scenes, "teapot:4:pot", 980),
          polygons(scenes, pot, 9120),
          bsp_leaves(scenes),
          node_counts(scenes),
          deep_nodes(scenes),
          first_level(scenes, pot, 3.0, 6),
          first_level(scenes, pot, 10.0, 8),
          first_level(scenes, large, 3.0, 6),
          first_level(scenes, large, 10.0, 8)};
}

std::vector<tables::Claim> check_access_claims(std::span<const TracedRun> runs) {
  const TracedRun* run = find_pot(runs);
  return {deep_accesses(run), access_drop(run), access_fall(run), worst_case(runs), frame_operations(runs)};
}

}  // namespace marti::studies::paper
