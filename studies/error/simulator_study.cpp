#include "studies/error/simulator_study.h"

#include <algorithm>

#include "memory/cache_config.h"
#include "sim/units.h"
#include "studies/estimate/simulator_analytic.h"
#include "studies/host/cpu_time.h"
#include "studies/paper/level_counts.h"
#include "studies/run/functional_run.h"

namespace marti::studies {

namespace {

std::vector<ErrorCase> cases_of(const ErrorConfig& config) {
  std::vector<ErrorCase> cases;
  for (std::size_t scene = 0; scene < config.scenes.size(); ++scene) {
    for (const std::uint64_t cache : config.caches) {
      for (const std::uint32_t nodes : config.nodes) {
        cases.push_back({scene, nodes, cache,
                         config.scenes[scene] + ", " + std::to_string(nodes) +
                             (nodes == 1 ? " node, " : " nodes, ") +
                             sim::print_size(static_cast<std::int64_t>(cache))});
      }
    }
  }
  return cases;
}

std::vector<LevelAccesses> levels_of(const std::string& scene, const processors::WorkLog& log) {
  const std::vector<LevelCount> counts = count_levels(log.topology);
  const NodeVisits visits = count_visits(log);
  std::vector<LevelAccesses> levels;
  double from_root = 0.0;
  for (std::size_t i = 0; i < visits.per_level.size(); ++i) {
    LevelAccesses level{scene, static_cast<std::uint32_t>(i + 1), visits.per_level[i], 0.0, 0.0};
    if (i == 0) {
      level.from_above = static_cast<double>(level.accesses);
      from_root = level.from_above;
    } else {
      const LevelCount& above = counts[i - 1];
      const double entered =
          4.0 * static_cast<double>(above.branches + above.partial) / static_cast<double>(above.nodes());
      level.from_above = entered * static_cast<double>(visits.per_level[i - 1]);
      from_root *= entered;
    }
    level.from_root = from_root;
    levels.push_back(level);
  }
  return levels;
}

// One scene's part of the study.
class SceneStudy {
 public:
  SceneStudy(const ErrorConfig& config, const processors::WorkLog& log, std::size_t scene,
             SimulatorStudy& study)
      : config_(config),
        log_(log),
        study_(study),
        first_(scene * config.nodes.size() * config.caches.size()) {}

  void run() {
    for (std::uint32_t repeat = 0; repeat < config_.repeats; ++repeat) {
      exact_seconds_.assign(config_.nodes.size() * config_.caches.size(), 0.0);
      for (std::size_t node = 0; node < config_.nodes.size(); ++node) {
        for (std::size_t cache = 0; cache < config_.caches.size(); ++cache) {
          run_machine(cache, node, repeat);
        }
        run_all_caches(node, repeat);
      }
      count_interpolation(repeat);
    }
    interpolate_all();
  }

 private:
  [[nodiscard]] std::size_t index(std::size_t cache, std::size_t node) const {
    return first_ + cache * config_.nodes.size() + node;
  }
  [[nodiscard]] processors::MachineConfig machine(std::size_t cache, std::size_t node) const {
    return machine_with(config_.machine, config_.nodes[node], config_.caches[cache]);
  }

  void run_machine(std::size_t cache, std::size_t node, std::uint32_t repeat) {
    const processors::MachineConfig config = machine(cache, node);
    const std::size_t number = index(cache, node);
    const std::span<const Method> methods = simulator_methods();
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if (!answers_alone(methods[m])) {
        continue;
      }
      // Every case draws samples of its own.
      const std::uint64_t seed = config_.seed * 0x9e3779b97f4a7c15ULL + number * methods.size() + m;
      const double begin = thread_cpu_seconds();
      Estimate found = estimate(methods[m], log_, config, seed);
      const double seconds = thread_cpu_seconds() - begin;
      study_.cpu_seconds[m][repeat] += seconds;
      if (methods[m].kind == MethodKind::exact) {
        exact_seconds_[number - first_] = seconds;
        study_.truth[number] = found;
      }
      study_.estimates[m][number] = found;
    }
  }

  void run_all_caches(std::size_t node, std::uint32_t repeat) {
    const std::span<const Method> methods = simulator_methods();
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if (!methods[m].all_caches) {
        continue;
      }
      std::vector<memory::CacheShape> shapes;
      for (std::size_t cache = 0; cache < config_.caches.size(); ++cache) {
        shapes.push_back(memory::shape_of(machine(cache, node).cache.cache));
      }
      const double begin = thread_cpu_seconds();
      std::vector<Estimate> found =
          estimate_analytically(log_, machine(0, node), shapes, {methods[m].walked_nodes});
      study_.cpu_seconds[m][repeat] += thread_cpu_seconds() - begin;
      for (std::size_t cache = 0; cache < found.size(); ++cache) {
        found[cache].words = cache == 0 ? found[cache].words : 0;  // one pass for all caches
        study_.estimates[m][index(cache, node)] = found[cache];
      }
    }
  }

  // Whether interpolation has this machine timed: every other machine of a row, and the last.
  [[nodiscard]] bool is_timed(const Method& method, std::size_t cache, std::size_t node) const {
    const std::size_t at = method.over_caches ? cache : node;
    const std::size_t count = method.over_caches ? config_.caches.size() : config_.nodes.size();
    return at % 2 == 0 || at + 1 == count;
  }

  void count_interpolation(std::uint32_t repeat) {
    const std::span<const Method> methods = simulator_methods();
    for (std::size_t m = 0; m < methods.size(); ++m) {
      for (std::size_t cache = 0; cache < config_.caches.size(); ++cache) {
        for (std::size_t node = 0; node < config_.nodes.size(); ++node) {
          if (methods[m].kind == MethodKind::interpolated && is_timed(methods[m], cache, node)) {
            study_.cpu_seconds[m][repeat] += exact_seconds_[index(cache, node) - first_];
          }
        }
      }
    }
  }

  // Estimates each machine that has neighbours on both sides from all others of its row. So the neighbours
  // are two steps of the row apart, as if only every other machine were timed.
  void interpolate_all() {
    const std::span<const Method> methods = simulator_methods();
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if (methods[m].kind != MethodKind::interpolated) {
        continue;
      }
      for (std::size_t cache = 0; cache < config_.caches.size(); ++cache) {
        for (std::size_t node = 0; node < config_.nodes.size(); ++node) {
          interpolate_one(m, methods[m], cache, node);
        }
      }
    }
  }

  void interpolate_one(std::size_t m, const Method& method, std::size_t cache, std::size_t node) {
    const std::size_t at = method.over_caches ? cache : node;
    const std::size_t count = method.over_caches ? config_.caches.size() : config_.nodes.size();
    if (at == 0 || at + 1 >= count) {
      return;
    }
    std::vector<double> sizes;
    std::vector<MachineFigures> machines;
    for (std::size_t i = 0; i < count; ++i) {
      if (i != at) {
        sizes.push_back(size_at(method, i));
        machines.push_back(study_.truth[method.over_caches ? index(i, node) : index(cache, i)].value);
      }
    }
    Estimate found = estimate_between(method.curve, sizes, machines, size_at(method, at));
    const Estimate& exact = study_.truth[index(cache, node)];
    found.references = exact.references;  // of the image, not of the machine
    study_.estimates[m][index(cache, node)] = found;
  }

  [[nodiscard]] double size_at(const Method& method, std::size_t i) const {
    return method.over_caches ? static_cast<double>(config_.caches[i])
                              : static_cast<double>(config_.nodes[i]);
  }

  const ErrorConfig& config_;
  const processors::WorkLog& log_;
  SimulatorStudy& study_;
  std::size_t first_;
  std::vector<double> exact_seconds_;  // of each machine, in this repeat
};

// Each machine's speed-up over one node with the same cache on the same scene, by the same method. Where that
// has no answer for one node, the exact one is taken.
void add_speed_ups(SimulatorStudy& study, std::size_t node_counts) {
  const auto one_node = [&](std::size_t number) { return number - number % node_counts; };
  for (std::size_t number = study.cases.size(); number-- > 0;) {
    add_speed_up(study.truth[number], study.truth[one_node(number)]);
  }
  for (std::vector<std::optional<Estimate>>& estimates : study.estimates) {
    for (std::size_t number = study.cases.size(); number-- > 0;) {
      if (estimates[number]) {
        const std::optional<Estimate>& one = estimates[one_node(number)];
        add_speed_up(*estimates[number], one ? *one : study.truth[one_node(number)]);
      }
    }
  }
}

}  // namespace

SimulatorStudy study_simulator(const ErrorConfig& config) {
  SimulatorStudy study;
  study.cases = cases_of(config);
  study.truth.resize(study.cases.size());
  const std::size_t methods = simulator_methods().size();
  study.estimates.assign(methods, std::vector<std::optional<Estimate>>(study.cases.size()));
  study.cpu_seconds.assign(methods, std::vector<double>(config.repeats, 0.0));
  for (std::size_t scene = 0; scene < config.scenes.size(); ++scene) {
    FrameConfig frame = config.frame;
    frame.scene = config.scenes[scene];
    const FunctionalRun run = run_functional(frame);
    SceneStudy(config, *run.frame.log, scene, study).run();
    if (frame.structure == "octree") {
      const std::vector<LevelAccesses> levels = levels_of(config.scenes[scene], *run.frame.log);
      study.levels.insert(study.levels.end(), levels.begin(), levels.end());
    }
  }
  add_speed_ups(study, config.nodes.size());
  return study;
}

}  // namespace marti::studies
