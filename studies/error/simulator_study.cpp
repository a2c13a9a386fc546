#include "studies/error/simulator_study.h"

#include <algorithm>

#include "memory/cache_config.h"
#include "sim/mix.h"
#include "sim/units.h"
#include "studies/estimate/sampled_frame.h"
#include "studies/estimate/simulator_analytic.h"
#include "studies/estimate/simulator_sample.h"
#include "studies/host/cpu_time.h"
#include "studies/paper/level_counts.h"
#include "studies/run/prepared_frame.h"
#include "studies/tables/text_units.h"

namespace marti::studies::error {

namespace {

std::vector<ErrorCase> cases_of(const ErrorConfig& config) {
  std::vector<ErrorCase> cases;
  std::size_t frame = 0;
  for (std::size_t scene = 0; scene < config.scenes.size(); ++scene) {
    for (const std::uint32_t side : config.sides) {
      for (const std::uint64_t cache : config.caches) {
        for (const std::uint32_t nodes : config.nodes) {
          cases.push_back({scene, frame, nodes, cache,
                           config.scenes[scene] + ", " + std::to_string(side) + " x " + std::to_string(side) +
                               ", " + tables::counted(nodes, "node") + ", " +
                               sim::print_size(static_cast<std::int64_t>(cache))});
        }
      }
      ++frame;
    }
  }
  return cases;
}

std::vector<LevelAccesses> levels_of(const std::string& scene, const processors::program::WorkLog& log) {
  const std::vector<paper::LevelCount> counts = paper::count_levels(log.topology);
  const paper::NodeVisits visits = paper::count_visits(log);
  std::vector<LevelAccesses> levels;
  double from_root = 0.0;
  for (std::size_t i = 0; i < visits.per_level.size(); ++i) {
    LevelAccesses level{scene, static_cast<std::uint32_t>(i + 1), visits.per_level[i], 0.0, 0.0};
    if (i == 0) {
      level.from_above = static_cast<double>(level.accesses);
      from_root = level.from_above;
    } else {
      const paper::LevelCount& above = counts[i - 1];
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

// The seconds of the process that `work` takes.
template <class Work>
double seconds_of(const Work& work) {
  const double begin = host::process_cpu_seconds();
  work();
  return host::process_cpu_seconds() - begin;
}

// One frame's part of the study.
class FrameStudy {
 public:
  FrameStudy(const ErrorConfig& config, const keys::FrameConfig& frame, std::size_t number,
             SimulatorStudy& study)
      : config_(config),
        study_(study),
        first_(number * config.nodes.size() * config.caches.size()),
        packets_(frame.render.width, frame.render.height, config.machine.packets) {
    preparing_ = seconds_of([&] { prepared_.emplace(frame); });
    tracing_ = seconds_of([&] { whole_ = prepared_->trace(); });
  }

  [[nodiscard]] const processors::program::WorkLog& log() const { return *whole_.log; }

  void run() {
    for (std::uint32_t repeat = 0; repeat < config_.repeats; ++repeat) {
      exact_seconds_.assign(config_.nodes.size() * config_.caches.size(), 0.0);
      for (std::size_t cache = 0; cache < config_.caches.size(); ++cache) {
        for (std::size_t m = 0; m < estimate::simulator_methods().size(); ++m) {
          sim::begin_part(config_.frame.meter, "timing machines by each method");
          run_method(m, cache, repeat);
        }
      }
      for (std::size_t node = 0; node < config_.nodes.size(); ++node) {
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
  [[nodiscard]] processors::machine::MachineConfig machine(std::size_t cache, std::size_t node) const {
    return machine_with(config_.machine, config_.nodes[node], config_.caches[cache]);
  }

  // Answers by one method for all numbers of nodes, the first of which is 1: an answer needs that of one
  // node.
  void run_method(std::size_t m, std::size_t cache, std::uint32_t repeat) {
    const estimate::Method& method = estimate::simulator_methods()[m];
    double one_node = 0.0;
    for (std::size_t node = 0; node < config_.nodes.size(); ++node) {
      const std::size_t number = index(cache, node);
      if (method.kind == estimate::MethodKind::sampled) {
        const double seconds = run_sample(m, cache, node);
        // Where the sample would be the frame, the exact run answers.
        study_.cpu_seconds[m][repeat] +=
            study_.estimates[m][number] ? preparing_ + seconds : exact_seconds_[number - first_];
      } else if (estimate::answers_alone(method)) {
        const double seconds = seconds_of(
            [&] { study_.estimates[m][number] = estimate::estimate(method, log(), machine(cache, node)); });
        const double all = preparing_ + tracing_ + seconds + one_node;
        one_node = node == 0 ? seconds : one_node;
        study_.cpu_seconds[m][repeat] += all;
        if (method.kind == estimate::MethodKind::exact) {
          exact_seconds_[number - first_] = all;
          study_.truth[number] = *study_.estimates[m][number];
        }
      }
    }
  }

  // A sample of the frame, unless it would be all of it or there are not so many strata. Every case draws
  // samples of its own. Returns the seconds that it took.
  double run_sample(std::size_t m, std::size_t cache, std::size_t node) {
    const std::size_t number = index(cache, node);
    const processors::machine::MachineConfig config = machine(cache, node);
    const std::uint64_t seed = sim::mix(config_.seed ^ sim::mix(number));
    return seconds_of([&] {
      const estimate::PacketWindows windows(packets_, estimate::window_length(config.nodes),
                                            estimate::simulator_methods()[m].strata, seed);
      if (windows.has_all() || windows.strata().size() < estimate::simulator_methods()[m].strata) {
        return;
      }
      estimate::SampledFrame sampled = estimate::sampled_frame(*prepared_);
      const processors::program::WorkLog& part = sampled.with(windows);
      estimate::SampledRun run = estimate::estimate_by_sample(part, config, windows, sampled.lattice());
      for (const processors::program::LogRow& row : part.rows) {
        run.machine.words += row.words.size();
      }
      study_.estimates[m][number] = run.machine;
    });
  }

  void run_all_caches(std::size_t node, std::uint32_t repeat) {
    const std::span<const estimate::Method> methods = estimate::simulator_methods();
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if (!methods[m].all_caches) {
        continue;
      }
      std::vector<memory::CacheShape> shapes;
      for (std::size_t cache = 0; cache < config_.caches.size(); ++cache) {
        shapes.push_back(memory::shape_of(machine(cache, node).cache.cache));
      }
      std::vector<estimate::Estimate> found;
      // One run answers for all caches.
      study_.cpu_seconds[m][repeat] += preparing_ + tracing_ + seconds_of([&] {
                                         found = estimate::estimate_analytically(
                                             log(), machine(0, node), shapes, {methods[m].walked_nodes});
                                       });
      for (std::size_t cache = 0; cache < found.size(); ++cache) {
        found[cache].words = cache == 0 ? found[cache].words : 0;  // one pass for all caches
        study_.estimates[m][index(cache, node)] = found[cache];
      }
    }
  }

  // Whether interpolation has this machine timed: every other machine of a row, and the last.
  [[nodiscard]] bool is_timed(const estimate::Method& method, std::size_t cache, std::size_t node) const {
    const std::size_t at = method.over_caches ? cache : node;
    const std::size_t count = method.over_caches ? config_.caches.size() : config_.nodes.size();
    return at % 2 == 0 || at + 1 == count;
  }

  void count_interpolation(std::uint32_t repeat) {
    const std::span<const estimate::Method> methods = estimate::simulator_methods();
    for (std::size_t m = 0; m < methods.size(); ++m) {
      for (std::size_t cache = 0; cache < config_.caches.size(); ++cache) {
        for (std::size_t node = 0; node < config_.nodes.size(); ++node) {
          if (methods[m].kind == estimate::MethodKind::interpolated && is_timed(methods[m], cache, node)) {
            study_.cpu_seconds[m][repeat] += exact_seconds_[index(cache, node) - first_];
          }
        }
      }
    }
  }

  // Estimates each machine that has neighbours on both sides from all others of its row. So the neighbours
  // are two steps of the row apart, as if only every other machine were timed.
  void interpolate_all() {
    const std::span<const estimate::Method> methods = estimate::simulator_methods();
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if (methods[m].kind != estimate::MethodKind::interpolated) {
        continue;
      }
      for (std::size_t cache = 0; cache < config_.caches.size(); ++cache) {
        for (std::size_t node = 0; node < config_.nodes.size(); ++node) {
          interpolate_one(m, methods[m], cache, node);
        }
      }
    }
  }

  void interpolate_one(std::size_t m, const estimate::Method& method, std::size_t cache, std::size_t node) {
    const std::size_t at = method.over_caches ? cache : node;
    const std::size_t count = method.over_caches ? config_.caches.size() : config_.nodes.size();
    if (at == 0 || at + 1 >= count) {
      return;
    }
    std::vector<double> sizes;
    std::vector<estimate::MachineFigures> machines;
    for (std::size_t i = 0; i < count; ++i) {
      if (i != at) {
        sizes.push_back(size_at(method, i));
        machines.push_back(study_.truth[method.over_caches ? index(i, node) : index(cache, i)].value);
      }
    }
    estimate::Estimate found = estimate::estimate_between(method.curve, sizes, machines, size_at(method, at));
    const estimate::Estimate& exact = study_.truth[index(cache, node)];
    found.references = exact.references;  // of the image, not of the machine
    study_.estimates[m][index(cache, node)] = found;
  }

  [[nodiscard]] double size_at(const estimate::Method& method, std::size_t i) const {
    return method.over_caches ? static_cast<double>(config_.caches[i])
                              : static_cast<double>(config_.nodes[i]);
  }

  const ErrorConfig& config_;
  SimulatorStudy& study_;
  std::size_t first_;
  processors::machine::PacketList packets_;
  std::optional<run::PreparedFrame> prepared_;
  processors::program::Frame whole_;
  double preparing_ = 0.0;             // seconds
  double tracing_ = 0.0;               // seconds, of the whole frame
  std::vector<double> exact_seconds_;  // of each machine's exact run, in this repeat
};

// Each machine's speed-up over one node with the same cache on the same frame, by the same method. Where that
// has no answer for one node, the exact one is taken. Samples have their speed-up already.
void add_speed_ups(SimulatorStudy& study, std::size_t node_counts) {
  const auto one_node = [&](std::size_t number) { return number - number % node_counts; };
  for (std::size_t number = study.cases.size(); number-- > 0;) {
    estimate::add_speed_up(study.truth[number], study.truth[one_node(number)]);
  }
  for (std::size_t m = 0; m < estimate::simulator_methods().size(); ++m) {
    std::vector<std::optional<estimate::Estimate>>& estimates = study.estimates[m];
    if (estimate::simulator_methods()[m].kind == estimate::MethodKind::sampled) {
      continue;
    }
    for (std::size_t number = study.cases.size(); number-- > 0;) {
      if (estimates[number]) {
        const std::optional<estimate::Estimate>& one = estimates[one_node(number)];
        estimate::add_speed_up(*estimates[number], one ? *one : study.truth[one_node(number)]);
      }
    }
  }
}

}  // namespace

SimulatorStudy study_simulator(const ErrorConfig& config) {
  SimulatorStudy study;
  study.cases = cases_of(config);
  study.truth.resize(study.cases.size());
  const std::size_t methods = estimate::simulator_methods().size();
  study.estimates.assign(methods, std::vector<std::optional<estimate::Estimate>>(study.cases.size()));
  study.cpu_seconds.assign(methods, std::vector<double>(config.repeats, 0.0));
  std::size_t number = 0;
  for (const std::string& scene : config.scenes) {
    for (const std::uint32_t side : config.sides) {
      keys::FrameConfig frame = config.frame;
      frame.scene = scene;
      frame.render.width = side;
      frame.render.height = side;
      FrameStudy part(config, frame, number++, study);
      part.run();
      if (frame.structure == "octree" && side == config.sides.front()) {
        const std::vector<LevelAccesses> levels = levels_of(scene, part.log());
        study.levels.insert(study.levels.end(), levels.begin(), levels.end());
      }
    }
  }
  add_speed_ups(study, config.nodes.size());
  return study;
}

}  // namespace marti::studies::error
