#include "studies/sweep/store/point_result.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "sim/error.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/setting_value.h"
#include "studies/run/frame_figures.h"
#include "studies/tables/json_table.h"

namespace marti::studies::sweep {

namespace {

using Json = nlohmann::ordered_json;

Json machine_figures(const SweepReader& sweep, const SweepRow& row, std::int64_t base_machine) {
  Json figures = Json::object();
  const auto enter = [&figures](const std::string& name, auto value) {
    figures[name] = tables::json_of(tables::Cell(value));
  };
  figures::for_each_count(figures::counted_figures(), row.counters, enter);
  const std::optional<SweepRow> base = sweep.read_result(base_machine);
  const std::optional<std::int64_t> other = sweep.compare();
  const std::optional<SweepRow> compared = other ? sweep.read_result(*other) : std::nullopt;
  figures::for_each_derived(
      {&row.counters, base ? &base->counters : nullptr, compared ? &compared->counters : nullptr}, enter);
  return figures;
}

Json frame_json(const FrameRow& frame) {
  Json figures = {{"scene", frame.scene}, {"image_hash", frame.image_hash}, {"hit_hash", frame.hit_hash}};
  figures::for_each_count(run::frame_figures(), frame.counters,
                          [&figures](const std::string& name, figures::Count value) {
                            figures[name] = tables::json_of(tables::Cell(value));
                          });
  return figures;
}

Json waits_json(const SweepRow& row, std::string_view what) {
  const auto at = std::ranges::find(histogram_names, what) - histogram_names.begin();
  const Json buckets = Json::parse(row.histograms.at(static_cast<std::size_t>(at)), nullptr, false);
  return {{"waits", {{"histogram_ps", buckets.is_array() ? buckets : Json::array()}}}};
}

}  // namespace

tables::RunJson point_result(const SweepReader& sweep, std::int64_t ordinal, const std::string& name) {
  const std::vector<StoredPoint> points = sweep.points();
  if (ordinal < 0 || static_cast<std::size_t>(ordinal) >= points.size()) {
    throw sim::UserError(name + ": there is no such point; the sweep has " + std::to_string(points.size()) +
                         ", numbered from 0");
  }
  const StoredPoint& point = points[static_cast<std::size_t>(ordinal)];
  const std::optional<SweepRow> row = sweep.read_result(point.machine);
  const std::optional<FrameRow> frame = sweep.read_frame(point.machine);
  if (!row || !frame) {
    throw sim::UserError(name + ": this point has not been run yet; run the sweep again to finish it");
  }
  std::vector<sim::EffectiveValue> settings;
  const std::vector<std::string>& axes = sweep.axes();
  for (const auto& [key, value] : sweep.settings(point.machine)) {
    const bool is_axis = std::ranges::find(axes, key) != axes.end();
    settings.push_back({key, value, is_axis, {}});
  }
  // The store has histograms of all clusters together.
  const Json waits = {{"interconnect", waits_json(*row, "interconnect_wait")},
                      {"banks", {waits_json(*row, "bank_wait")}},
                      {"distributed", {{"network", waits_json(*row, "network_wait")}}}};
  Json result = {
      {"marti", {{"version", sweep.version()}}},
      {"config", keys::config_json(name, settings)},
      {"figures", {{"frame", frame_json(*frame)}, {"machine", machine_figures(sweep, *row, point.base)}}},
      {"scene", {{"hash", frame->scene_hash}}},
      {"machine", {{"per_cluster", Json::array({waits})}}}};
  return {std::move(result), name, tables::MadeBy::sweep};
}

}  // namespace marti::studies::sweep
