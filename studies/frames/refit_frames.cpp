#include "studies/frames/refit_frames.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "accel/bvh.h"
#include "accel/structure.h"
#include "accel/two_level.h"
#include "processors/program/render.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "sim/finished_parts.h"
#include "sim/joined.h"
#include "studies/frames/frame_sequence.h"
#include "studies/frames/frame_tables.h"
#include "studies/frames/refit_tables.h"
#include "studies/frames/refit_work.h"
#include "studies/keys/frame_keys.h"
#include "studies/run/functional_run.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"

namespace marti::studies::frames {

namespace {

using accel::Bvh;
using accel::TriangleSet;
using accel::TwoLevelBvh;
using Set = std::shared_ptr<const TriangleSet>;
using Clock = std::chrono::steady_clock;

Bvh refit(const Bvh& tree, const Set& moved) { return tree.refitted(moved); }
TwoLevelBvh refit(const TwoLevelBvh& tree, const Set& moved) {
  return tree.moved(moved, TwoLevelBvh::Update::refit);
}
double cost_of(const Bvh& tree) { return tree.sah_cost(); }
double cost_of(const TwoLevelBvh& /*tree*/) { return 0.0; }

template <class Tree>
class RefitStudy {
 public:
  explicit RefitStudy(const FramesConfig& config)
      : config_(config), sequence_(config.frame), options_(config.frame.structure_options.bvh) {
    options_.memory = config.frame.memory;
  }

  void run() {
    sim::plan_parts(config_.frame.meter, "frames", sequence_.size());
    sim::begin_part(config_.frame.meter, "building, tracing and timing");
    sequence_.visit([this](const PosedFrame& pose) { add(pose); });
  }

  std::vector<RefitFrame> outcomes;
  std::vector<tables::StudyImage> images;

 private:
  static constexpr bool has_top = std::is_same_v<Tree, TwoLevelBvh>;
  using Shared = std::shared_ptr<const accel::StructureOf<Tree>>;

  /// A set, and the tree that was built for it; null as long as none was needed.
  struct Built {
    Set set;
    Shared tree;
  };

  [[nodiscard]] Shared build(const Set& set) const {
    return std::make_shared<const accel::StructureOf<Tree>>(Tree::build(set, options_));
  }
  const Tree& tree_of(Built& built) const {
    if (!built.tree) {
      built.tree = build(built.set);
    }
    return built.tree->concrete();
  }

  void add(const PosedFrame& pose) {
    Built now{std::make_shared<const TriangleSet>(pose.scene), nullptr};
    RefitFrame& outcome = outcomes.emplace_back();
    processors::program::Image image;
    sim::once(
        config_.frame.meter, "frames", std::to_string(pose.number),
        [&] { image = traced_and_timed(pose, now, outcome); }, outcome, image.width, image.height,
        image.pixels);
    images.push_back({fmt::format("frame-{:04}", pose.number), std::move(image)});
    if (!first_.set) {
      first_ = now;
    }
    if constexpr (!has_top) {
      now.tree = nullptr;
    }
    before_ = std::move(now);
  }

  processors::program::Image traced_and_timed(const PosedFrame& pose, Built& now, RefitFrame& outcome) {
    outcome.number = pose.number;
    outcome.seconds = pose.seconds;
    const Moved moved = moved_between(before_.set.get(), *now.set);
    outcome.moved = moved.count;
    const auto noted = [&](RefitWay way, const auto& make) {
      RefitOutcome& of = outcome.of(way);
      const Clock::time_point begin = Clock::now();
      Shared tree = make();
      of.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      of.cost = cost_of(tree->concrete());
      const processors::cost::TreeWork work = work_of(tree->concrete(), moved, way);
      of.records = work.branches + work.instances;
      of.bytes = work.branches * config_.machine.layout.node_bytes +
                 work.instances * config_.machine.layout.transform_bytes;
      of.making = before_.set || way == RefitWay::rebuild
                      ? processors::cost::least_time(work, config_.machine)
                      : outcome.of(RefitWay::rebuild).making;
      return tree;
    };
    const auto shared = [](Tree tree) {
      return std::make_shared<const accel::StructureOf<Tree>>(std::move(tree));
    };
    now.tree = noted(RefitWay::rebuild, [&] { return build(now.set); });
    outcome.branches = outcome.of(RefitWay::rebuild).records;
    processors::program::Frame frame = trace_pose(config_.frame, pose, *now.set, *now.tree, stop_);
    outcome.hit_hash = frame.hit_hash;
    outcome.image_hash = run::image_hash(frame.image);
    outcome.of(RefitWay::rebuild).render = processors::replay::replay(*frame.log, config_.machine).end;
    if constexpr (has_top) {
      const Tree& old = tree_of(before_.set ? before_ : now);
      const Shared tree = noted(RefitWay::rebuild_top,
                                [&] { return shared(old.moved(now.set, TwoLevelBvh::Update::rebuild)); });
      sim::ensure(tree->topology() == now.tree->topology(), "a top level rebuilt gives another tree");
      outcome.of(RefitWay::rebuild_top).render = outcome.of(RefitWay::rebuild).render;
    }
    const Tree& first = tree_of(first_.set ? first_ : now);
    const Shared tree = noted(RefitWay::refit, [&] { return shared(refit(first, now.set)); });
    frame = trace_pose(config_.frame, pose, *now.set, *tree, stop_);
    sim::ensure(frame.hit_hash == outcome.hit_hash && run::image_hash(frame.image) == outcome.image_hash,
                "a refitted tree gives another image than one built from nothing");
    outcome.of(RefitWay::refit).render = processors::replay::replay(*frame.log, config_.machine).end;
    return std::move(frame.image);
  }

  const FramesConfig& config_;
  sim::WorkMeter stop_{config_.frame.meter};  // of a frame's rows, which are not shown
  FrameSequence sequence_;
  accel::BvhOptions options_;
  Built first_;
  Built before_;
};

std::string refit_head(const sim::Config& config, const FramesConfig& frames,
                       const std::vector<RefitFrame>& all, const std::vector<std::string>& answer,
                       bool instances) {
  return sim::joined(answer, "\n") + "\n" +
         subject_text(config, frames, all.size(), ", each equal with all trees") +
         fmt::format(
             "\n"
             "rebuild      the tree is built for the frame\n"
             "{}"
             "refit        the first frame's tree, its boxes fitted to the frame\n",
             instances ? "rebuild_top  the same tree; trees of meshes in which nothing moved are kept\n"
                       : "");
}

template <class Tree>
tables::StudyOutput output_of(sim::Config& config, const FramesConfig& frames) {
  RefitStudy<Tree> study(frames);
  study.run();
  const bool instances = std::is_same_v<Tree, TwoLevelBvh>;
  tables::StudyOutput output;
  output.tables = {refit_frame_table(study.outcomes), refit_table(study.outcomes, instances),
                   refit_total_table(study.outcomes, instances)};
  const auto beside = [&](const char* figure, const char* title) {
    return tables::side_by_side(output.tables[1], "frame", "way", figure, title) + "\n";
  };
  const std::vector<std::string> answer = refit_answer(study.outcomes, instances);
  output.report = refit_head(config, frames, study.outcomes, answer, instances) + "\n" +
                  tables::text_of(output.tables[0]) + "\n" +
                  beside("share", "Making the tree: share of the cycle, at least") +
                  beside("render", "Render: time of each frame") + beside("cycle", "Cycle: both") +
                  beside("slower", "Longer than with the rebuilt tree") +
                  beside("records", "Records written before the frame") + tables::text_of(output.tables[2]);
  output.tables.push_back(tables::answer_table("frames_answer", "Which way has the shortest cycles", answer));
  output.tables.push_back(tables::provenance_table(config.effective_values()));
  output.host_tables = {host_refit_table(study.outcomes, instances), tables::host_table()};
  output.host_report = tables::text_of(output.host_tables[0]) + "\n" + tables::text_of(output.host_tables[1]);
  output.images = std::move(study.images);
  return output;
}

}  // namespace

tables::StudyOutput run_refit_frames(sim::Config& config, const FramesConfig& frames) {
  const FrameSequence poses(frames.frame);
  const bool instances = !poses.scene().at(frames.frame.frames.time(0)).instances.empty();
  return instances ? output_of<TwoLevelBvh>(config, frames) : output_of<Bvh>(config, frames);
}

}  // namespace marti::studies::frames
