#include "studies/sweep/work/frame_log.h"

#include <algorithm>
#include <string>
#include <vector>

#include "scenes/open.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/shown.h"
#include "studies/run/functional_run.h"
#include "studies/run/open_frame.h"
#include "studies/run/scene_hash.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_points.h"

namespace marti::studies::sweep {

namespace {

FrameLog trace(const SweepFrame& frame) {
  const keys::FrameConfig& config = frame.config;
  if (config.log != nullptr) {
    const run::FunctionalRun run = run::run_functional(config);
    return {run.frame.log, frame_row(run, config.log->id)};
  }
  const scenes::Scene scene = run::open_frame(config);
  const std::uint64_t hash = run::scene_hash(scene);
  if (frame.scene_hash && *frame.scene_hash != hash) {
    const bool given = !config.open.rays.empty();
    throw sim::KeyError("scene.source", sim::shown(config.scene) + ": the scene" +
                                            (given ? ", or what is in the file of image.rays," : "") +
                                            " has changed since the sweep was begun; begin it again");
  }
  const run::FunctionalRun run = run::run_functional(config, scene);
  return {run.frame.log, frame_row(run, hash)};
}

// The first of the frame's machines whose value of the key is not the default, else the first of the frame's
// machines; plan.machines.size() where the frame has none.
std::size_t at_fault(const SweepPlan& plan, std::size_t frame, const std::string& key) {
  const auto machine = [&](const auto& is_it) {
    return static_cast<std::size_t>(
        std::ranges::find_if(plan.machines,
                             [&](const SweepMachine& each) { return each.frame == frame && is_it(each); }) -
        plan.machines.begin());
  };
  const sim::Schema& schema = sweep_schema();
  const std::size_t with_key = machine([&](const SweepMachine& each) {
    return std::ranges::any_of(all_of(each.settings), [&](const sim::EffectiveValue& value) {
      const sim::Key& declared = schema.keys()[*schema.find(value.key)];
      return value.key == key && value.value != print_values(declared, declared.default_value);
    });
  });
  return with_key != plan.machines.size() ? with_key : machine([](const SweepMachine&) { return true; });
}

template <class Item, class Allocator>
std::uint64_t reserved(const std::vector<Item, Allocator>& items) {
  return items.capacity() * sizeof(Item);
}

}  // namespace

FrameLog trace_frame(const SweepPlan& plan, std::size_t frame) {
  try {
    return trace(plan.frames[frame]);
  } catch (const sim::UserError& error) {
    const std::size_t machine = at_fault(plan, frame, error.place().key);
    if (machine == plan.machines.size()) {
      sim::with_places(plan.frames[frame].settings, plan.file, [] { throw; });
    }
    try {
      sim::with_places(settings_of(plan, machine), plan.file, [] { throw; });
    } catch (const sim::UserError& placed) {
      throw sim::UserError(placed.what() + asked_by(plan, machine), placed);
    }
    throw;
  }
}

std::string asked_by(const SweepPlan& plan, std::size_t machine) {
  constexpr const char* source = "scene.source";
  const auto point = std::ranges::find(plan.points, machine, &SweepPoint::machine);
  std::string text;
  if (point == plan.points.end()) {
    for (const sim::EffectiveValue& value : all_of(plan.machines[machine].settings)) {
      if (value.given) {
        text += (text.empty() ? "the machine with " : ", ") + value.key + " = " + value.value;
      }
    }
  } else {
    text = "the point " + point_text(sweep_schema(), plan.axes, point->values);
  }
  const bool says_scene =
      point != plan.points.end() && std::ranges::find(plan.axes, source) != plan.axes.end();
  const std::string scene = says_scene ? "" : plan.frames[plan.machines[machine].frame].config.scene;
  text += (text.empty() ? "a machine" : "") + (scene.empty() ? "" : " on " + scene);
  return " (" + sim::shown(text) + ")";
}

std::vector<sim::EffectiveValue> settings_of(const SweepPlan& plan, std::size_t machine) {
  std::vector<sim::EffectiveValue> settings = plan.frames[plan.machines[machine].frame].settings;
  for (const sim::EffectiveValue& value : all_of(plan.machines[machine].settings)) {
    settings.push_back(value);
  }
  return settings;
}

std::uint64_t memory_of(const processors::program::WorkLog& log) {
  std::uint64_t bytes = reserved(log.topology.nodes) + reserved(log.topology.entries) +
                        reserved(log.topology.work) + reserved(log.quadrics) + reserved(log.texture_begin) +
                        reserved(log.rows);
  for (const processors::program::LogRow& row : log.rows) {
    bytes += reserved(row.words) + reserved(row.begin);
    for (const processors::program::RowWords* const words : row.beside()) {
      bytes += reserved(words->words) + reserved(words->begin);
    }
  }
  return bytes;
}

}  // namespace marti::studies::sweep
