#include "studies/frames/refit_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "studies/frames/frame_tables.h"
#include "studies/tables/text_units.h"

namespace marti::studies::frames {

namespace {

std::string_view name_of(RefitWay way) { return refit_way_names[static_cast<std::size_t>(way)]; }

std::vector<RefitWay> ways_of(bool instances) {
  return instances ? std::vector{RefitWay::rebuild, RefitWay::rebuild_top, RefitWay::refit}
                   : std::vector{RefitWay::rebuild, RefitWay::refit};
}

/// By which fraction `after` is more than `before`.
double more(sim::Ticks after, sim::Ticks before) {
  return before == 0 ? 0.0 : static_cast<double>(after) / static_cast<double>(before) - 1.0;
}
/// How much longer the frame takes than with the rebuilt tree, as a fraction.
double slower(const RefitFrame& frame, RefitWay way) {
  return more(frame.of(way).render, frame.of(RefitWay::rebuild).render);
}
double saved(const RefitFrame& frame, RefitWay way) {
  return 0.0 - more(frame.of(way).cycle(), frame.of(RefitWay::rebuild).cycle());
}

double share_of_making(const RefitOutcome& of) {
  return of.cycle() == 0 ? 0.0 : static_cast<double>(of.making.all()) / static_cast<double>(of.cycle());
}

/// Sums over all frames but the first, which is built in every way; `making` has the longer of its times.
RefitFrame total_of(std::span<const RefitFrame> frames) {
  RefitFrame total;
  for (const RefitFrame& frame : frames.empty() ? frames : frames.subspan(1)) {
    for (std::size_t way = 0; way < refit_ways; ++way) {
      const RefitOutcome& of = frame.ways[way];
      RefitOutcome& sum = total.ways[way];
      sum.making.compute = sim::add_ticks(sum.making.compute, of.making.all());
      sum.render = sim::add_ticks(sum.render, of.render);
      sum.records += of.records;
      sum.bytes += of.bytes;
    }
  }
  return total;
}

std::string_view doing(RefitWay way) {
  constexpr std::array<std::string_view, refit_ways> names = {"Rebuilding", "Rebuilding the top level",
                                                              "Refitting"};
  return names[static_cast<std::size_t>(way)];
}

std::string shortest_line(const RefitFrame& total, std::size_t later, bool instances) {
  std::vector<RefitWay> ways = ways_of(instances);
  std::ranges::stable_sort(ways, {}, [&](RefitWay way) { return total.of(way).cycle(); });
  const RefitOutcome& best = total.of(ways[0]);
  const RefitOutcome& next = total.of(ways[1]);
  if (best.cycle() == next.cycle()) {
    return fmt::format("The cycles of {} and {} are equally long, {} at least", name_of(ways[0]),
                       name_of(ways[1]), tables::seconds(best.cycle()));
  }
  std::string text =
      shortest_text(doing(ways[0]), best.cycle(), later, -more(best.cycle(), next.cycle()), name_of(ways[1]));
  if (const sim::Ticks making = best.making.all(); making > 0) {
    text += fmt::format(
        ", unless its trees take {} times the least time",
        tables::times(1.0 + static_cast<double>(next.cycle() - best.cycle()) / static_cast<double>(making)));
  }
  return text;
}

}  // namespace

std::vector<std::string> refit_answer(std::span<const RefitFrame> frames, bool instances) {
  if (frames.size() < 2) {
    return {"One frame: there is nothing to refit"};
  }
  const RefitFrame total = total_of(frames);
  const auto slowest = std::ranges::max_element(
      frames, {}, [](const RefitFrame& frame) { return slower(frame, RefitWay::refit); });
  const auto shorter = std::ranges::find_if(frames, [](const RefitFrame& frame) {
    return frame.of(RefitWay::rebuild).cycle() < frame.of(RefitWay::refit).cycle();
  });
  std::vector<std::string> answer = {shortest_line(total, frames.size() - 1, instances)};
  if (const std::uint64_t all = total.of(RefitWay::rebuild).records; all > 0) {
    answer.push_back(fmt::format(
        "Refitting writes {} of the records that rebuilding does, and frames take at most {} longer (frame "
        "{})",
        tables::rough_percent(static_cast<double>(total.of(RefitWay::refit).records) /
                              static_cast<double>(all)),
        tables::rough_percent(slower(*slowest, RefitWay::refit)), slowest->number));
  }
  if (shorter != frames.end()) {
    answer.push_back(
        fmt::format("Frame {} is the first whose cycle is shorter with the rebuilt tree", shorter->number));
  }
  return answer;
}

tables::Table refit_frame_table(std::span<const RefitFrame> frames) {
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

tables::Table refit_table(std::span<const RefitFrame> frames, bool instances) {
  tables::Table table(
      "refits", "Each frame with each tree",
      {tables::count_column("frame", "number of the frame"),
       tables::text_column("way", "how its tree is made; the first frame's is built"),
       tables::integer_column("compute", "ps",
                              "least time of the operations of making it, divided among all nodes"),
       tables::integer_column("transfer", "ps", "least time to read and write what that needs"),
       tables::integer_column("making", "ps", "the longer of both: the tree takes at least so long"),
       tables::integer_column("render", "ps", "time of the frame"),
       tables::integer_column("cycle", "ps", "making and render"),
       tables::real_column("share", "fraction", "of making in the cycle, at least"),
       tables::real_column("saved", "fraction", "of the cycle with the rebuilt tree"),
       tables::real_column("slower", "fraction",
                           "by which the frame takes longer than with the rebuilt tree"),
       tables::integer_column("moves", "byte", "read and written to make the tree, at least"),
       tables::count_column("records",
                            "records of branches and transforms that are written before the frame"),
       tables::integer_column("written", "byte", "bytes of these"),
       tables::real_column("cost", "",
                           "expected visits and tests of a ray that meets the root's box; without kept "
                           "instances")});
  for (const RefitFrame& frame : frames) {
    for (const RefitWay way : ways_of(instances)) {
      const RefitOutcome& of = frame.of(way);
      table.add_row({frame.number, name_of(way), of.making.compute, of.making.memory, of.making.all(),
                     of.render, of.cycle(), share_of_making(of), saved(frame, way), slower(frame, way),
                     of.making.read + of.making.written, of.records, of.bytes,
                     instances ? tables::Cell() : tables::Cell(of.cost)});
    }
  }
  return table;
}

tables::Table refit_total_table(std::span<const RefitFrame> frames, bool instances) {
  tables::Table table(
      "totals", "All frames but the first",
      {tables::text_column("way", "how the trees are made"),
       tables::integer_column("making", "ps", "least time of making the trees"),
       tables::integer_column("render", "ps", "time of the frames"),
       tables::integer_column("cycle", "ps", "both"),
       tables::real_column("share", "fraction", "of making in the cycles, at least"),
       tables::real_column("saved", "fraction", "of the cycles with rebuilt trees"),
       tables::real_column("slower", "fraction", "by which the frames take longer than with rebuilt trees"),
       tables::count_column("records", "records that are written before the frames"),
       tables::integer_column("written", "byte", "bytes of these")});
  const RefitFrame total = total_of(frames);
  for (const RefitWay way : ways_of(instances)) {
    const RefitOutcome& of = total.of(way);
    table.add_row({name_of(way), of.making.all(), of.render, of.cycle(), share_of_making(of),
                   saved(total, way), slower(total, way), of.records, of.bytes});
  }
  return table;
}

tables::Table host_refit_table(std::span<const RefitFrame> frames, bool instances) {
  tables::Table table("host_frames", "The trees on the host",
                      {tables::count_column("frame", "number of the frame"),
                       tables::text_column("way", "how its tree is made"),
                       tables::real_column("seconds", "s", "for that, on the host")});
  for (const RefitFrame& frame : frames) {
    for (const RefitWay way : ways_of(instances)) {
      table.add_row({frame.number, name_of(way), frame.of(way).seconds});
    }
  }
  return table;
}

}  // namespace marti::studies::frames
