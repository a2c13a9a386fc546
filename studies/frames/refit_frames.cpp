#include "studies/frames/refit_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "accel/bvh.h"
#include "accel/moved_primitives.h"
#include "accel/structure.h"
#include "accel/two_level.h"
#include "processors/program/render.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "sim/finished_parts.h"
#include "sim/units.h"
#include "studies/frames/frame_sequence.h"
#include "studies/frames/frame_tables.h"
#include "studies/keys/frame_keys.h"
#include "studies/run/functional_run.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::frames {

namespace {

using accel::Bvh;
using accel::TriangleSet;
using accel::TwoLevelBvh;
using Set = std::shared_ptr<const TriangleSet>;
using Clock = std::chrono::steady_clock;

enum class RefitWay : std::uint8_t { rebuild, rebuild_top, refit };
constexpr std::size_t refit_ways = 3;
constexpr std::array<std::string_view, refit_ways> way_names = {"rebuild", "rebuild_top", "refit"};
constexpr auto index_of = [](RefitWay way) { return static_cast<std::size_t>(way); };

struct RefitOutcome {
  sim::Ticks render = 0;
  std::uint64_t records = 0;  ///< of branches and transforms that are written before the frame
  std::uint64_t bytes = 0;    ///< of these
  double cost = 0.0;          ///< Bvh::sah_cost; 0 with kept instances
  double seconds = 0.0;       ///< host: making the tree
};

struct RefitFrame {
  std::uint32_t number = 0;
  double seconds = 0.0;
  std::uint64_t moved = 0;     ///< primitives, in all instances
  std::uint64_t branches = 0;  ///< of the rebuilt tree, its instances among them
  std::uint64_t hit_hash = 0;
  std::uint64_t image_hash = 0;
  std::array<RefitOutcome, refit_ways> ways;

  [[nodiscard]] const RefitOutcome& of(RefitWay way) const { return ways[index_of(way)]; }
  /// How much longer the frame takes than with the rebuilt tree, as a fraction.
  [[nodiscard]] double slower(RefitWay way) const {
    const auto rebuilt = static_cast<double>(of(RefitWay::rebuild).render);
    return rebuilt == 0.0 ? 0.0 : static_cast<double>(of(way).render) / rebuilt - 1.0;
  }
};

/// What has moved between two frames.
struct Moved {
  std::vector<bool> primitives;  // in the coordinates of their meshes
  std::vector<bool> instances;
  std::uint64_t count = 0;  // of primitives, in all instances
};

Moved moved_between(const TriangleSet* before, const TriangleSet& after) {
  Moved moved;
  moved.primitives.assign(after.size(), before == nullptr);
  moved.instances.assign(after.instances().size(), before == nullptr);
  if (before == nullptr) {
    return moved;
  }
  for (const std::uint32_t id : accel::moved_primitives(*before, after)) {
    moved.primitives[id] = true;
  }
  for (std::size_t i = 0; i < moved.instances.size(); ++i) {
    const scenes::InstancePlace& now = after.instances()[i];
    const scenes::InstancePlace& then = before->instances()[i];
    moved.instances[i] = now.linear != then.linear || now.shift != then.shift;
    const accel::PrimitiveRange& mesh = after.meshes()[now.mesh];
    const auto first = moved.primitives.begin() + mesh.first;
    moved.count += moved.instances[i]
                       ? mesh.count
                       : static_cast<std::uint64_t>(std::count(first, first + mesh.count, true));
  }
  if (after.instances().empty()) {
    moved.count = static_cast<std::uint64_t>(std::ranges::count(moved.primitives, true));
  }
  return moved;
}

const std::vector<std::uint32_t>& instances_of(const TwoLevelBvh& tree) { return tree.instance_of(); }
const std::vector<std::uint32_t>& instances_of(const Bvh& /*tree*/) {
  static const std::vector<std::uint32_t> none;
  return none;
}

/// By node: whether something below it has moved, so that its record holds other boxes or another transform.
/// Children have higher numbers than their parents.
template <class Tree>
std::vector<bool> altered(const Tree& tree, const Moved& moved) {
  const accel::Topology& topology = tree.topology();
  const std::vector<std::uint32_t>& instances = instances_of(tree);
  std::vector<bool> nodes(topology.nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {
    const accel::TopologyNode& node = topology.nodes[n];
    bool any = node.instance && moved.instances[instances[n]];
    for (std::uint32_t i = node.first; i < node.first + node.count && !any; ++i) {
      any = node.leaf ? moved.primitives[topology.entries[i]] : nodes[i];
    }
    nodes[n] = any;
  }
  return nodes;
}

/// By node: whether its record is written. Those of all nodes; those of the top level and of meshes in which
/// something has moved; or those above what has moved.
template <class Tree>
std::vector<bool> written_nodes(const Tree& tree, const Moved& moved, RefitWay way) {
  const std::vector<accel::TopologyNode>& nodes = tree.topology().nodes;
  if (way == RefitWay::rebuild) {
    return std::vector<bool>(nodes.size(), true);
  }
  std::vector<bool> written = altered(tree, moved);
  if (way == RefitWay::refit) {
    return written;
  }
  const std::size_t top = instances_of(tree).size();
  std::fill_n(written.begin(), top, true);
  // The roots of meshes are on one level, which no other node behind the top level's is on.
  for (std::size_t n = top + 1; n < nodes.size(); ++n) {
    written[n] = nodes[n].level == nodes[top].level ? written[n] : written[n - 1];
  }
  return written;
}

/// Notes how many records a way writes. Leaves have none.
template <class Tree>
void count_records(const Tree& tree, const Moved& moved, RefitWay way, const memory::LayoutConfig& layout,
                   RefitOutcome& outcome) {
  const std::vector<bool> written = written_nodes(tree, moved, way);
  for (std::size_t n = 0; n < written.size(); ++n) {
    const accel::TopologyNode& node = tree.topology().nodes[n];
    if (written[n] && !node.leaf) {
      ++outcome.records;
      outcome.bytes += node.instance ? layout.transform_bytes : layout.node_bytes;
    }
  }
}

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

  void add(const PosedFrame& pose) {
    const Set set = std::make_shared<const TriangleSet>(pose.scene);
    if (!first_) {
      first_ = Tree::build(set, options_);
    }
    RefitFrame& outcome = outcomes.emplace_back();
    processors::program::Image image;
    sim::once(
        config_.frame.meter, "frames", std::to_string(pose.number),
        [&] { image = traced_and_timed(pose, set, outcome); }, outcome, image.width, image.height,
        image.pixels);
    images.push_back({fmt::format("frame-{:04}", pose.number), std::move(image)});
    before_ = set;
  }

  processors::program::Image traced_and_timed(const PosedFrame& pose, const Set& set, RefitFrame& outcome) {
    outcome.number = pose.number;
    outcome.seconds = pose.seconds;
    const Moved moved = moved_between(before_.get(), *set);
    outcome.moved = moved.count;
    processors::program::Image image;
    const auto add_way = [&](RefitWay way, const auto& make) {
      RefitOutcome& of = outcome.ways[index_of(way)];
      const Clock::time_point begin = Clock::now();
      const accel::StructureOf<Tree> tree(make());
      of.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      of.cost = cost_of(tree.concrete());
      count_records(tree.concrete(), moved, way, config_.machine.layout, of);
      if (way == RefitWay::rebuild_top) {
        sim::ensure(tree.topology().nodes.size() == rebuilt_nodes_, "a top level rebuilt gives another tree");
        of.render = outcome.of(RefitWay::rebuild).render;  // of an equal tree
        return;
      }
      processors::program::Frame frame = trace_pose(config_.frame, pose, *set, tree, stop_);
      if (way == RefitWay::rebuild) {
        rebuilt_nodes_ = tree.topology().nodes.size();
        outcome.branches = of.records;
        outcome.hit_hash = frame.hit_hash;
        outcome.image_hash = run::image_hash(frame.image);
      }
      sim::ensure(frame.hit_hash == outcome.hit_hash && run::image_hash(frame.image) == outcome.image_hash,
                  "a refitted tree gives another image than one built from nothing");
      of.render = processors::replay::replay(*frame.log, config_.machine).end;
      image = std::move(frame.image);
    };
    add_way(RefitWay::rebuild, [&] { return Tree::build(set, options_); });
    if constexpr (has_top) {
      add_way(RefitWay::rebuild_top, [&] { return first_->moved(set, TwoLevelBvh::Update::rebuild); });
    }
    add_way(RefitWay::refit, [&] { return refit(*first_, set); });
    return image;
  }

  const FramesConfig& config_;
  sim::WorkMeter stop_{config_.frame.meter};  // of a frame's rows, which are not shown
  FrameSequence sequence_;
  accel::BvhOptions options_;
  std::optional<Tree> first_;
  Set before_;
  std::size_t rebuilt_nodes_ = 0;
};

template <class Visit>
void each_way(bool instances, const Visit& visit) {
  for (const RefitWay way : {RefitWay::rebuild, RefitWay::rebuild_top, RefitWay::refit}) {
    if (instances || way != RefitWay::rebuild_top) {
      visit(way);
    }
  }
}

tables::Table refit_frame_table(const std::vector<RefitFrame>& frames) {
  tables::Table table(
      "frames", "Frames: what moved",
      {tables::count_column("frame", "number of the frame"),
       tables::real_column("time", "s", "from the animation's beginning"),
       tables::count_column("moved", "primitives that moved since the frame before, in all instances"),
       tables::count_column("branches", "branches and instances of the rebuilt tree"),
       tables::text_column("hit_hash", "hash of every ray's outcome, with each tree"),
       tables::text_column("image_hash", "hash of the pixels' bits, with each tree")});
  for (const RefitFrame& frame : frames) {
    table.add_row({frame.number, frame.seconds, frame.moved, frame.branches, hash_text(frame.hit_hash),
                   hash_text(frame.image_hash)});
  }
  return table;
}

tables::Table refit_table(const std::vector<RefitFrame>& frames, bool instances) {
  tables::Table table(
      "refits", "Each frame with each tree",
      {tables::count_column("frame", "number of the frame"),
       tables::text_column("way", "how its tree is made"),
       tables::integer_column("render", "ps", "time of the frame, the tree being given"),
       tables::real_column("slower", "fraction", "by which it takes longer than with the rebuilt tree"),
       tables::count_column("records",
                            "records of branches and transforms that are written before the frame"),
       tables::integer_column("written", "byte", "bytes of these"),
       tables::real_column("cost", "",
                           "expected visits and tests of a ray that meets the root's box; without kept "
                           "instances")});
  for (const RefitFrame& frame : frames) {
    each_way(instances, [&](RefitWay way) {
      const RefitOutcome& of = frame.of(way);
      table.add_row({frame.number, way_names[index_of(way)], of.render, frame.slower(way), of.records,
                     of.bytes, instances ? tables::Cell() : tables::Cell(of.cost)});
    });
  }
  return table;
}

tables::Table refit_total_table(const std::vector<RefitFrame>& frames, bool instances) {
  tables::Table table(
      "totals", "All frames together",
      {tables::text_column("way", "how the trees are made"),
       tables::integer_column("render", "ps", "time of the frames, the trees being given"),
       tables::real_column("slower", "fraction", "by which they take longer than with rebuilt trees"),
       tables::count_column("records", "records that are written before frames, but the first one"),
       tables::integer_column("written", "byte", "bytes of these")});
  const auto sum = [&](RefitWay way) {
    RefitOutcome all;
    for (const RefitFrame& frame : frames) {
      const bool first = &frame == frames.data();
      all.render = sim::add_ticks(all.render, frame.of(way).render);
      all.records += first ? 0 : frame.of(way).records;
      all.bytes += first ? 0 : frame.of(way).bytes;
    }
    return all;
  };
  RefitFrame total;
  each_way(instances, [&](RefitWay way) { total.ways[index_of(way)] = sum(way); });
  each_way(instances, [&](RefitWay way) {
    const RefitOutcome& of = total.of(way);
    table.add_row({way_names[index_of(way)], of.render, total.slower(way), of.records, of.bytes});
  });
  return table;
}

tables::Table host_refit_table(const std::vector<RefitFrame>& frames, bool instances) {
  tables::Table table("host_frames", "The trees on the host",
                      {tables::count_column("frame", "number of the frame"),
                       tables::text_column("way", "how its tree is made"),
                       tables::real_column("seconds", "s", "for that, on the host")});
  for (const RefitFrame& frame : frames) {
    each_way(instances, [&](RefitWay way) {
      table.add_row({frame.number, way_names[index_of(way)], frame.of(way).seconds});
    });
  }
  return table;
}

std::string answer_of(const std::vector<RefitFrame>& frames) {
  const auto slowest = std::ranges::max_element(
      frames, {}, [](const RefitFrame& frame) { return frame.slower(RefitWay::refit); });
  std::uint64_t refitted = 0;
  std::uint64_t rebuilt = 0;
  for (const RefitFrame& frame : frames) {
    const bool first = &frame == frames.data();
    refitted += first ? 0 : frame.of(RefitWay::refit).records;
    rebuilt += first ? 0 : frame.of(RefitWay::rebuild).records;
  }
  if (rebuilt == 0) {
    return "One frame: there is nothing to refit\n";
  }
  return fmt::format(
      "Refitting writes {:.1f} % of the records that rebuilding does, and frames take at most "
      "{:.1f} % longer "
      "(frame {})\n",
      100.0 * static_cast<double>(refitted) / static_cast<double>(rebuilt),
      100.0 * slowest->slower(RefitWay::refit), slowest->number);
}

std::string refit_head(const sim::Config& config, const FramesConfig& frames,
                       const std::vector<RefitFrame>& all, bool instances) {
  return answer_of(all) + subject_text(config, frames, all.size(), ", each equal with all trees") +
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
  const tables::Table& refits = output.tables[1];
  output.report =
      refit_head(config, frames, study.outcomes, instances) + "\n" + tables::text_of(output.tables[0]) +
      "\n" + tables::side_by_side(refits, "frame", "way", "render", "Render: time of each frame") + "\n" +
      tables::side_by_side(refits, "frame", "way", "slower", "Longer than with the rebuilt tree") + "\n" +
      tables::side_by_side(refits, "frame", "way", "records", "Records written before the frame") + "\n" +
      tables::text_of(output.tables[2]);
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
