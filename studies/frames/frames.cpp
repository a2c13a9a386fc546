#include "studies/frames/frames.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "accel/bvh.h"
#include "processors/program/render.h"
#include "sim/error.h"
#include "sim/finished_parts.h"
#include "sim/units.h"
#include "studies/frames/frame_sequence.h"
#include "studies/frames/frame_tables.h"
#include "studies/frames/frame_ways.h"
#include "studies/frames/frames_config.h"
#include "studies/frames/refit_frames.h"
#include "studies/run/functional_run.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::frames {

namespace {

/// Renders the frame again with a tree of its own, whose root fits it tightly as in a run of one frame: the
/// image must be the same. With the voxel cut the cells must be those of `tree`, or the image is another
/// approximation.
void verify(const FramesConfig& config, const PosedFrame& pose, const FrameTree& tree,
            const processors::program::Frame& frame) {
  accel::OctreeOptions options = config.frame.structure_options.octree;
  if (config.frame.render.voxel_cut > 0.0) {
    options = tree.octree->concrete().options();
  }
  const accel::StructureOf<accel::Octree> fresh(accel::Octree::build(tree.triangles, options));
  const processors::program::Frame other =
      processors::program::render(pose.scene, *tree.triangles, fresh, config.frame.render);
  sim::ensure(other.hit_hash == frame.hit_hash && other.image.pixels.size() == frame.image.pixels.size() &&
                  run::image_hash(other.image) == run::image_hash(frame.image),
              "an updated octree gives another image than one built from nothing");
}

class FramesStudy {
 public:
  explicit FramesStudy(const FramesConfig& config)
      : config_(config), sequence_(config.frame), ways_(config.machine) {
    options_ = config.frame.structure_options.octree;
    options_.enclose = sequence_.bounds();
  }

  void run() {
    sim::plan_parts(config_.frame.meter, "frames", sequence_.size());
    sim::begin_part(config_.frame.meter, "building, tracing and timing");
    sequence_.visit([this](const PosedFrame& pose) { add(pose); });
  }

  [[nodiscard]] const std::vector<FrameOutcome>& outcomes() const { return outcomes_; }
  [[nodiscard]] std::vector<tables::StudyImage> take_images() { return std::move(images_); }

 private:
  // A frame that is finished still gets its tree, from which that of the next one is made.
  void add(const PosedFrame& pose) {
    FrameTree tree = make_frame_tree(before_ ? &*before_ : nullptr, pose.scene, options_);
    FrameOutcome& outcome = outcomes_.emplace_back();
    processors::program::Image image;
    sim::once(
        config_.frame.meter, "frames", std::to_string(pose.number),
        [&] { image = traced_and_timed(pose, tree, outcome); }, outcome, image.width, image.height,
        image.pixels, ways_.built());
    images_.push_back({fmt::format("frame-{:04}", pose.number), std::move(image)});
    tree.update.reset();
    before_ = std::move(tree);
  }

  processors::program::Image traced_and_timed(const PosedFrame& pose, const FrameTree& tree,
                                              FrameOutcome& outcome) {
    processors::program::Frame frame = trace_pose(config_.frame, pose, *tree.triangles, *tree.octree, stop_);
    if (config_.verify) {
      verify(config_, pose, tree, frame);
    }
    outcome.number = pose.number;
    outcome.seconds = pose.seconds;
    outcome.change = change_of(tree);
    outcome.hit_hash = frame.hit_hash;
    outcome.image_hash = run::image_hash(frame.image);
    outcome.build_seconds = tree.build_seconds;
    outcome.update_seconds = tree.update_seconds;
    outcome.ways = ways_.time(*frame.log, tree.update ? &*tree.update : nullptr);
    return std::move(frame.image);
  }

  const FramesConfig& config_;
  sim::WorkMeter stop_{config_.frame.meter};  // of a frame's rows, which are not shown
  FrameSequence sequence_;
  accel::OctreeOptions options_;
  FrameWays ways_;
  std::optional<FrameTree> before_;
  std::vector<FrameOutcome> outcomes_;
  std::vector<tables::StudyImage> images_;
};

std::string head_of(const sim::Config& config, const FramesConfig& frames, std::size_t count) {
  const processors::machine::BuildConfig& build = frames.machine.build;
  std::string initial = "the whole tree";
  if (build.initial == processors::machine::InitialTree::level) {
    initial = fmt::format("level {}", build.level);
  } else if (build.initial == processors::machine::InitialTree::rule) {
    initial = fmt::format("the level of rule k = {:g}", build.rule_k);
  }
  return subject_text(config, frames, count,
                      frames.verify ? ", each equal to that of a tree built from nothing" : "") +
         fmt::format(
             "\n"
             "rebuild_all      the whole tree is built before each frame\n"
             "partial          altered branches are built anew before each frame, the rest is kept\n"
             "dynamic          built before each frame to {}, the rest on demand ({})\n"
             "partial_dynamic  altered branches are built anew on demand, the rest is kept as it is\n",
             initial, processors::machine::sharing_names[static_cast<std::size_t>(build.sharing)]);
}

}  // namespace

tables::StudyOutput run_frames(sim::Config& config, sim::WorkMeter* meter) {
  FramesConfig frames = read_frames(config);
  frames.frame.wait_with(meter);
  if (frames.frame.structure == accel::Bvh::kind_name) {
    return run_refit_frames(config, frames);
  }
  FramesStudy study(frames);
  study.run();
  const std::vector<FrameOutcome>& outcomes = study.outcomes();

  tables::StudyOutput output;
  output.tables = {frame_table(outcomes), cycle_table(outcomes), total_table(outcomes)};
  const tables::Table& cycles = output.tables[1];
  const std::string answer = ways_answer(outcomes);
  output.report =
      answer + "\n" + head_of(config, frames, outcomes.size()) + "\n" + tables::text_of(output.tables[0]) +
      "\n" + tables::side_by_side(cycles, "frame", "way", "build", "Build: time before each frame") + "\n" +
      tables::side_by_side(cycles, "frame", "way", "render",
                           "Render: time of each frame, building on demand included") +
      "\n" + tables::side_by_side(cycles, "frame", "way", "cycle", "Cycle: both") + "\n" +
      tables::side_by_side(cycles, "frame", "way", "splits", "Branches split, before the frame and in it") +
      "\n" +
      tables::side_by_side(cycles, "frame", "way", "memory",
                           "Memory: records and lists at the end of each frame") +
      "\n" + tables::text_of(output.tables[2]);
  output.tables.push_back(
      tables::answer_table("frames_answer", "Which way has the shortest cycles", std::array{answer}));
  output.tables.push_back(tables::provenance_table(config.effective_values()));
  output.host_tables = {host_frame_table(outcomes), tables::host_table()};
  output.host_report = tables::text_of(output.host_tables[0]) + "\n" + tables::text_of(output.host_tables[1]);
  output.images = study.take_images();
  return output;
}

}  // namespace marti::studies::frames
