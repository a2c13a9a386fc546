#include "studies/sweep/work/frame_log.h"

#include <vector>

#include "scenes/open.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/shown.h"
#include "studies/run/functional_run.h"
#include "studies/run/open_frame.h"
#include "studies/run/scene_hash.h"

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

template <class Item, class Allocator>
std::uint64_t reserved(const std::vector<Item, Allocator>& items) {
  return items.capacity() * sizeof(Item);
}

}  // namespace

FrameLog trace_frame(const SweepPlan& plan, std::size_t frame) {
  return sim::with_places(plan.frames[frame].settings, plan.file, [&] { return trace(plan.frames[frame]); });
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
