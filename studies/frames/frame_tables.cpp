#include "studies/frames/frame_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "sim/units.h"
#include "studies/keys/frame_keys.h"
#include "studies/tables/text_units.h"

namespace marti::studies::frames {

namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// The time saved against rebuilding the whole tree, as a fraction of the rebuild's time.
double saved(sim::Ticks time, sim::Ticks rebuild) {
  return rebuild == 0 ? 0.0 : static_cast<double>(rebuild - time) / static_cast<double>(rebuild);
}

sim::Ticks cycle_of(const FrameOutcome& frame, FrameWay way) {
  return frame.ways[static_cast<std::size_t>(way)].cycle();
}

}  // namespace

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string subject_text(const sim::Config& config, const FramesConfig& frames, std::size_t count,
                         std::string_view images) {
  return fmt::format(
      "scene    {}, {} at {:g} a second, the first is number {}\n"
      "images   {}{}\n"
      "machine  {} at {}, operations as \"{}\"\n",
      frames.frame.scene, tables::counted(count, "frame"), frames.frame.frames.rate,
      frames.frame.frames.first, keys::size_text(frames.frame.render), images,
      tables::counted(frames.machine.all_nodes(), "node"),
      sim::print_frequency(config.frequency("node.clock")), config.choice_name("costs.preset"));
}

TreeChange change_of(const FrameTree& tree) {
  TreeChange change;
  const accel::Topology& topology = tree.topology();
  change.nodes = topology.nodes.size();
  for (std::size_t node = 0; node < topology.nodes.size(); ++node) {
    if (!topology.nodes[node].leaf) {
      ++change.branches;
      change.all_sorted += topology.work[node].listed;
      change.all_tests += topology.work[node].overlaps;
    }
  }
  if (!tree.update) {
    change.altered = change.nodes;
    change.split = change.branches;
    change.sorted = change.all_sorted;
    change.tests = change.all_tests;
    return change;
  }
  const accel::OctreeUpdate& update = *tree.update;
  change.moved = update.moved;
  for (std::uint32_t node = 0; node < update.nodes.size(); ++node) {
    change.altered += update.altered(node) ? 1 : 0;
    change.resorted += update.nodes[node] == accel::NodeUpdate::resorted ? 1 : 0;
    change.split += update.nodes[node] == accel::NodeUpdate::split ? 1 : 0;
    change.sorted += update.work[node].listed;
    change.tests += update.work[node].overlaps;
  }
  return change;
}

std::string shortest_text(std::string_view best, sim::Ticks cycles, std::size_t frames, double less,
                          std::string_view than) {
  return fmt::format("{} has the shortest cycles, {} for {}", best, tables::seconds(cycles),
                     tables::counted(frames, "frame")) +
         (less == 0.0 ? std::string() : fmt::format(", {} less than {}", tables::rough_percent(less), than));
}

std::string ways_answer(std::span<const FrameOutcome> frames) {
  std::array<sim::Ticks, frame_ways> cycles{};
  for (const FrameOutcome& frame : frames) {
    for (std::size_t way = 0; way < frame_ways; ++way) {
      cycles[way] = sim::add_ticks(cycles[way], frame.ways[way].cycle());
    }
  }
  const auto best = static_cast<std::size_t>(std::ranges::min_element(cycles) - cycles.begin());
  return shortest_text(frame_way_names[best], cycles[best], frames.size(), saved(cycles[best], cycles[0]),
                       frame_way_names[0]);
}

tables::Table frame_table(std::span<const FrameOutcome> frames) {
  tables::Table table(
      "frames", "Frames: what moved, and what an update of the tree alters",
      {tables::count_column("frame", "number of the frame"),
       tables::real_column("time", "s", "from the animation's beginning"),
       tables::count_column("moved", "primitives that moved since the frame before"),
       tables::count_column("nodes", "nodes of the whole tree"),
       tables::count_column("branches", "of these, branches"),
       tables::count_column("altered", "nodes whose record or list must be made anew"),
       tables::real_column("kept", "fraction", "nodes that stay as they were"),
       tables::count_column("resorted", "branches that sort moved primitives only"),
       tables::count_column("split", "branches whose children are made anew"),
       tables::real_column("sorted", "fraction",
                           "primitives that the update sorts, once a node, against a build from nothing"),
       tables::real_column("tests", "fraction", "overlap tests that it runs, against such a build"),
       tables::text_column("hit_hash", "hash of every ray's outcome"),
       tables::text_column("image_hash", "hash of the pixels' bits")});
  for (const FrameOutcome& frame : frames) {
    const TreeChange& change = frame.change;
    table.add_row({frame.number, frame.seconds, change.moved, change.nodes, change.branches, change.altered,
                   share(change.nodes - change.altered, change.nodes), change.resorted, change.split,
                   share(change.sorted, change.all_sorted), share(change.tests, change.all_tests),
                   hash_text(frame.hit_hash), hash_text(frame.image_hash)});
  }
  return table;
}

tables::Table cycle_table(std::span<const FrameOutcome> frames) {
  tables::Table table(
      "cycles", "The cycle \"build, render\" of each frame",
      {tables::count_column("frame", "number of the frame"),
       tables::text_column("way", "how the machine comes by the frame's tree"),
       tables::integer_column("build", "ps", "time for building before the frame"),
       tables::integer_column("render", "ps", "time of the frame, building on demand included"),
       tables::integer_column("cycle", "ps", "both"),
       tables::integer_column("building", "ps",
                              "compute time for building before the frame and in it, all nodes together"),
       tables::count_column("start_up_splits", "branches split before the frame"),
       tables::count_column("splits", "branches split before the frame and in it"),
       tables::count_column("branches", "branches at the end of the frame"),
       tables::count_column("partial", "partially built nodes at the end of the frame"),
       tables::integer_column("memory", "byte", "records and lists at the end of the frame"),
       tables::real_column("cycle_saved", "fraction", "of the cycle with the whole tree rebuilt")});
  for (const FrameOutcome& frame : frames) {
    const sim::Ticks rebuild = cycle_of(frame, FrameWay::rebuild_all);
    for (std::size_t way = 0; way < frame_ways; ++way) {
      const WayOutcome& outcome = frame.ways[way];
      table.add_row({frame.number, frame_way_names[way], outcome.build, outcome.render, outcome.cycle(),
                     outcome.building, outcome.start_up_splits, outcome.all_splits(), outcome.branches,
                     outcome.partial, outcome.bytes, saved(outcome.cycle(), rebuild)});
    }
  }
  return table;
}

tables::Table total_table(std::span<const FrameOutcome> frames) {
  tables::Table table(
      "totals", "All frames together",
      {tables::text_column("way", "how the machine comes by a frame's tree"),
       tables::integer_column("build", "ps", "time for building before frames"),
       tables::integer_column("render", "ps", "time of frames, building on demand included"),
       tables::integer_column("cycle", "ps", "both"),
       tables::integer_column("building", "ps", "compute time for building, all nodes together"),
       tables::count_column("splits", "branches split"),
       tables::integer_column("largest", "byte", "records and lists, of the frame with most"),
       tables::real_column("cycle_saved", "fraction", "of the cycles with the whole tree rebuilt"),
       tables::real_column("later_saved", "fraction",
                           "the same without the first frame, before which there is no tree")});
  for (std::size_t way = 0; way < frame_ways; ++way) {
    WayOutcome sum;
    sim::Ticks rebuild = 0;
    std::int64_t splits = 0;
    for (const FrameOutcome& frame : frames) {
      const WayOutcome& outcome = frame.ways[way];
      sum.build = sim::add_ticks(sum.build, outcome.build);
      sum.render = sim::add_ticks(sum.render, outcome.render);
      sum.building = sim::add_ticks(sum.building, outcome.building);
      sum.bytes = std::max(sum.bytes, outcome.bytes);
      splits += outcome.all_splits();
      rebuild = sim::add_ticks(rebuild, cycle_of(frame, FrameWay::rebuild_all));
    }
    tables::Cell later;
    if (frames.size() > 1) {
      const FrameOutcome& first = frames.front();
      later = saved(sum.cycle() - first.ways[way].cycle(), rebuild - cycle_of(first, FrameWay::rebuild_all));
    }
    table.add_row({frame_way_names[way], sum.build, sum.render, sum.cycle(), sum.building, splits, sum.bytes,
                   saved(sum.cycle(), rebuild), later});
  }
  return table;
}

tables::Table host_frame_table(std::span<const FrameOutcome> frames) {
  tables::Table table(
      "host_frames", "The trees on the host",
      {tables::count_column("frame", "number of the frame"),
       tables::real_column("build", "s", "the tree from nothing, on all host threads"),
       tables::real_column("update", "s", "the tree from the one before, on one host thread")});
  for (const FrameOutcome& frame : frames) {
    const bool first = &frame == frames.data();
    table.add_row(
        {frame.number, frame.build_seconds, first ? tables::Cell() : tables::Cell(frame.update_seconds)});
  }
  return table;
}

}  // namespace marti::studies::frames
