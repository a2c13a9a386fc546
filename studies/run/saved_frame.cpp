#include "studies/run/saved_frame.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "processors/program/log_rules.h"
#include "sim/key_error.h"
#include "sim/shown.h"
#include "studies/host/program_build.h"
#include "studies/log_file/log_fields.h"

namespace marti::studies::run {

namespace {

using log_file::Described;
using log_file::Fields;

/// All of a run but its log, what follows from that, and its images.
template <class Stream, Described<FunctionalRun> Run>
void describe(Fields<Stream>& fields, Run& run) {
  auto& scene = run.scene;
  fields(scene.name, scene.polygons, scene.triangles, scene.spheres, scene.cylinders, scene.cones,
         scene.vertices, scene.distinct_positions, scene.degenerate_triangles, scene.duplicate_triangles,
         scene.materials, scene.textures, scene.texels, scene.lights);
  for (auto* corner : {&scene.bounds.lo, &scene.bounds.hi}) {
    fields(corner->x, corner->y, corner->z);
  }
  for (auto* notes : {&run.notes, &run.structure_notes}) {
    fields.each(*notes, [&](auto& note) { fields(note); });
  }
  fields.each(run.levels, [&](auto& level) {
    fields(level.branches, level.leaves, level.empty_leaves, level.entries, level.overfull_leaves);
  });
  fields(run.frame.rays.traced, run.frame.rays.hit, run.frame.rays.voxels, run.frame.hit_hash,
         run.frame.voxels, run.frame.first_voxel_level, run.image_hash);
  fields.each(run.plan.entries, [&](auto& entry) {
    fields.choice(entry.item, plan_items);
    fields.choice(entry.decision, plan_decision_names.size());
    fields(entry.fact);
  });
}

// What the structure of the configuration is walked by.
accel::Traversal traversal_of(const keys::FrameConfig& config) {
  using accel::Traversal;
  if (config.structure == accel::Octree::kind_name) {
    return Traversal::octree;
  }
  if (config.structure == accel::Bsp::kind_name) {
    return accel::traversal_of(config.structure_options.bsp.walk);
  }
  if (config.structure == accel::Bvh::kind_name) {
    return accel::traversal_of(config.structure_options.bvh.node);
  }
  return config.structure == accel::Grid::kind_name ? Traversal::grid : Traversal::none;
}

// Whether the log is of a frame that its own settings describe.
bool fits(const processors::program::WorkLog& log, const keys::FrameConfig& config) {
  const processors::program::RenderOptions& render = config.render;
  return log.width == render.width && log.height == render.height && log.samples == render.samples &&
         log.integrator == render.integrator && log.mailboxes == render.mailboxes &&
         log.traversal == traversal_of(config) && log.order == render.order &&
         log.treelet_records == render.treelet_records && log.has_entered() == render.entered &&
         log.has_ray_words() == render.ray_words && log.has_meets() == render.meets &&
         (log.voxels == 0 || render.voxel_cut > 0.0);
}

// Texts of the file, which anybody may have written, may have control characters: these are made visible,
// because notes and facts are printed without another look.
void make_printable(FunctionalRun& run) {
  for (std::vector<std::string>* const notes : {&run.notes, &run.structure_notes}) {
    for (std::string& note : *notes) {
      note = sim::shown(note, sim::all_shown);
    }
  }
  for (PlanEntry& entry : run.plan.entries) {
    entry.fact = sim::shown(entry.fact, sim::all_shown);
  }
}

// What is left out while a frame is traced is left out of its log.
void refuse_kept(const KeptItems& keep) {
  for (std::size_t item = 0; item < plan_items; ++item) {
    const auto one = static_cast<PlanItem>(item);
    if (keep.has(one) && one != PlanItem::contention && one != PlanItem::cache) {
      throw sim::KeyError("scene.log", "a log is what it is: \"" + std::string(name_of(one)) +
                                           "\" can be kept only while the scene is traced");
    }
  }
}

FunctionalRun read_saved(const keys::LoggedFrame& saved, const keys::FrameConfig& config) {
  log_file::PackedReader reader(saved.file);
  if (reader.id() != saved.id) {
    reader.fail("has changed since its settings were read");
  }
  reader.limit(config.memory);
  Fields<log_file::PackedReader> fields(reader);
  log_file::LogHead head;
  FunctionalRun run;
  auto log = std::make_shared<processors::program::WorkLog>();
  log_file::describe(fields, head);
  describe(fields, run);
  log_file::describe(fields, *log);
  reader.end();
  std::string fault = processors::program::fault_of(*log);
  if (fault.empty()) {
    fault = fits(*log, config) ? processors::program::fault_of_order(*log)
                               : "its settings are those of another image or structure";
  }
  if (!fault.empty()) {
    reader.fail("is no work log that can be timed: " + fault);
  }
  make_printable(run);
  run.frame.image.width = log->width;
  run.frame.image.height = log->height;
  run.frame.log = std::move(log);
  return run;
}

}  // namespace

void save_frame(const FunctionalRun& frame, const processors::program::RenderOptions& render,
                std::span<const sim::EffectiveValue> values, log_file::PackedWriter& file) {
  const processors::program::WorkLog& log = *frame.frame.log;
  log_file::LogHead head;
  for (const sim::EffectiveValue& value : values) {
    if (keys::is_kept_in_log(value.key)) {
      head.settings.push_back({value.key, value.value});
    }
  }
  head.program = host::build_of_program();
  head.width = log.width;
  head.height = log.height;
  head.entered = log.has_entered();
  head.ray_words = log.has_ray_words();
  head.meets = log.has_meets();
  head.order = render.order;
  head.treelet_records = render.treelet_records;
  Fields<log_file::PackedWriter> fields(file);
  log_file::describe(fields, std::as_const(head));
  describe(fields, frame);
  log_file::describe(fields, log);
  file.commit();
}

FunctionalRun open_saved_frame(const keys::FrameConfig& config) {
  refuse_kept(config.keep);
  sim::begin_part(config.meter, "reading the log");
  FunctionalRun run =
      sim::KeyError::reported_under("scene.log", [&] { return read_saved(*config.log, config); });
  run.totals = processors::program::totals_of(*run.frame.log);
  if (config.render.voxel_cut > 0.0) {
    run.voxel_cut.emplace().use = database_use(*run.frame.log);
  }
  return run;
}

}  // namespace marti::studies::run
