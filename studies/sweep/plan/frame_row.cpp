#include <fmt/format.h>

#include "studies/sweep/plan/sweep_row.h"

namespace marti::studies::sweep {

FrameRow frame_row(const run::FunctionalRun& run, std::uint64_t scene_hash) {
  FrameRow row;
  row.counters = run::frame_counts(run);
  row.scene = run.scene.name;
  row.scene_hash = fmt::format("{:016x}", scene_hash);
  row.image_hash = fmt::format("{:016x}", run.image_hash);
  row.hit_hash = fmt::format("{:016x}", run.frame.hit_hash);
  row.notes = run.notes;
  row.notes.insert(row.notes.end(), run.structure_notes.begin(), run.structure_notes.end());
  return row;
}

}  // namespace marti::studies::sweep
