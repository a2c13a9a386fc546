#include "studies/compare/figures.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::studies {

namespace {

// The name of a time ends in its unit, as in result.json.
std::string name_of(const Column& column) { return column.name + (column.unit == "ps" ? "_ps" : ""); }

void add(std::span<const Column> columns, const std::vector<std::optional<std::int64_t>>& counters,
         const std::string& prefix, Figures& figures) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (counters[i]) {
      figures[prefix + name_of(columns[i])] = *counters[i];
    }
  }
}

}  // namespace

void add_counters(const SweepRow& row, Figures& figures) { add(sweep_columns(), row.counters, "", figures); }

ComparedResult read_point(const SweepReader& sweep, std::int64_t ordinal, const std::string& name) {
  const std::vector<StoredPoint> points = sweep.points();
  if (ordinal < 0 || static_cast<std::size_t>(ordinal) >= points.size()) {
    throw sim::UserError(name + ": there is no such point; the sweep has " + std::to_string(points.size()) +
                         ", numbered from 0");
  }
  const std::int64_t machine = points[static_cast<std::size_t>(ordinal)].machine;
  const std::optional<SweepRow> row = sweep.read_result(machine);
  if (!row) {
    throw sim::UserError(name + ": this point has not been run yet; run the sweep again to finish it");
  }
  ComparedResult result;
  result.name = name;
  result.version = sweep.version();
  for (auto& [key, value] : sweep.settings(machine)) {
    result.settings[key] = value;
  }
  add_counters(*row, result.figures);
  if (const std::optional<FrameRow> frame = sweep.read_frame(machine)) {
    add(frame_columns(), frame->counters, "frame.", result.figures);
    result.figures["frame.scene"] = frame->scene;
    result.figures["frame.image_hash"] = frame->image_hash;
    result.figures["frame.hit_hash"] = frame->hit_hash;
  }
  return result;
}

}  // namespace marti::studies
