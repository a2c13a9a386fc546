#include "studies/compare/results.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "sim/error.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/setting_value.h"
#include "studies/run/frame_figures.h"
#include "studies/tables/json_table.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/run_json.h"

namespace marti::studies::compare {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view expected =
    "expected is a directory of `marti run`, its result.json, the directory of a sweep, or DIR:N for point N "
    "of a sweep";

void add(const tables::RunJson& run, const std::string& part, const std::string& prefix, Figures& figures) {
  for (const auto& [name, value] : run.at(part).items()) {
    const tables::Cell cell = tables::cell_of(value);
    if (!std::holds_alternative<std::monostate>(cell) && is_compared(prefix + name)) {
      figures[prefix + name] = cell;
    }
  }
}

ComparedResult read_run(const fs::path& file, const std::string& name) {
  const tables::RunJson run = tables::read_run_json(file);
  ComparedResult result;
  result.name = name;
  result.version = run.find("marti.version").is_string() ? run.text("marti.version") : "unknown";
  result.settings = keys::settings_of(run);
  add(run, "figures.frame", "frame.", result.figures);
  add(run, "figures.machine", "", result.figures);
  result.scene_hash = run.text("scene.hash");
  result.noise = run.optional_number("machine.what_helps.noise.band", 0.0, 1e18);
  result.helps = run.text("machine.what_helps.sentence");
  return result;
}

void add_counts(std::span<const figures::FigureEntry> entries, const figures::Counts& counts,
                const std::string& prefix, Figures& figures) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (counts[i] && entries[i].of_machine()) {
      figures[prefix + entries[i].name] = *counts[i];
    }
  }
}

void add_frame(const sweep::FrameRow& row, ComparedResult& result) {
  result.scene_hash = row.scene_hash;
  result.figures["frame.scene"] = row.scene;
  result.figures["frame.image_hash"] = row.image_hash;
  result.figures["frame.hit_hash"] = row.hit_hash;
  add_counts(run::frame_figures(), row.counters, "frame.", result.figures);
}

// Whether a result may depend on the setting, so that a sweep keeps it.
bool is_kept(std::string_view key) {
  return !key.starts_with("host_machine.") && !key.starts_with("prices.") && !key.starts_with("record.");
}

ComparedResult read_point(const sweep::SweepReader& store, const sweep::StoredPoint& point, bool derived) {
  ComparedResult result;
  result.name = fmt::format("{}:{}", store.file().string(), point.ordinal);
  result.version = store.version();
  for (auto& [key, value] : store.settings(point.machine)) {
    if (is_kept(key)) {
      result.settings.emplace(std::move(key), std::move(value));
    }
  }
  if (const std::optional<sweep::FrameRow> frame = store.read_frame(point.machine)) {
    add_frame(*frame, result);
  }
  const figures::Counts counts = store.read_result(point.machine)->counters;
  add_counts(figures::counted_figures(), counts, "", result.figures);
  if (!derived) {
    return result;
  }
  for (const figures::FigureEntry& entry : figures::derived_figures()) {
    // One that is measured against another machine has no value without that machine.
    const std::optional<double> value = figures::figure_of({&counts}, entry.name);
    if (value && entry.of_machine()) {
      result.figures[entry.name] = *value;
    }
  }
  const std::map<std::int64_t, sweep::Advice> advice = store.advice();
  if (const auto measured = advice.find(point.machine); measured != advice.end()) {
    result.helps = measured->second.sentence;
  }
  return result;
}

}  // namespace

Results::Results(const std::string& name) : name_(name) {
  std::error_code ignored;
  fs::path file = name;
  std::optional<tables::PointName> one;
  if (fs::is_directory(name, ignored)) {
    file = tables::results_in(name, expected);
  } else if (!tables::is_there(name)) {
    one = tables::point_named(name);
    if (!one) {
      throw sim::UserError(name + ": there is no such file or directory; " + std::string(expected));
    }
    file = one->store;
  }
  if (!one && file.extension() != ".sqlite") {
    last_ = read_run(file, name);
    points_.emplace_back().done = true;
    return;
  }
  store_.emplace(file);
  axes_ = store_->axes();
  is_sweep_ = !one;
  points_ = store_->points();
  if (is_sweep_) {
    name_ = file.string();
    return;
  }
  if (one->ordinal < 0 || static_cast<std::size_t>(one->ordinal) >= points_.size()) {
    throw sim::UserError(
        fmt::format("{}: there is no such point; the sweep has {}, numbered from 0", name, points_.size()));
  }
  points_ = {points_[static_cast<std::size_t>(one->ordinal)]};
  if (!points_[0].done) {
    throw sim::UserError(name + ": this point has not been run yet; run the sweep again to finish it");
  }
}

const ComparedResult& Results::at(const sweep::StoredPoint& point, bool derived) {
  if (store_ && last_point_ != point.ordinal) {
    last_ = read_point(*store_, point, derived);
    last_point_ = point.ordinal;
  }
  return last_;
}

sweep::Noise Results::noise() const {
  if (!store_) {
    return {last_.noise.value_or(0.0)};
  }
  if (!is_sweep_) {
    const std::map<std::int64_t, sweep::Advice> advice = store_->advice();
    const auto measured = advice.find(points_[0].machine);
    if (measured != advice.end() && measured->second.noise) {
      return {*measured->second.noise};
    }
  }
  return store_->noise();
}

void Results::keep_what_sweeps_have(bool derived) {
  for (const figures::FigureEntry& entry : figures::derived_figures()) {
    if (!derived || entry.formula->is_relative()) {
      last_.figures.erase(entry.name);
    }
  }
  std::erase_if(last_.settings, [](const auto& setting) { return !is_kept(setting.first); });
}

}  // namespace marti::studies::compare
