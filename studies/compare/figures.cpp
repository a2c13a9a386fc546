#include "studies/compare/figures.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "sim/error.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/setting_value.h"
#include "studies/run/frame_figures.h"
#include "studies/sweep/store/point_result.h"
#include "studies/tables/json_table.h"
#include "studies/tables/run_json.h"

namespace marti::studies::compare {

namespace {

using Json = nlohmann::ordered_json;

void add(const tables::RunJson& run, const std::string& part, const std::string& prefix, Figures& figures) {
  for (const auto& [name, value] : run.at(part).items()) {
    if (const tables::Cell cell = tables::cell_of(value); !std::holds_alternative<std::monostate>(cell)) {
      figures[prefix + name] = cell;
    }
  }
}

ComparedResult compared(const tables::RunJson& run, const std::string& name) {
  ComparedResult result;
  result.name = name;
  const Json& version = run.find("marti.version");
  result.version = version.is_string() ? version.get<std::string>() : "unknown";
  result.settings = keys::settings_of(run);
  add(run, "figures.frame", "frame.", result.figures);
  add(run, "figures.machine", "", result.figures);
  result.scene_hash = run.text("scene.hash");
  result.helps = run.text("machine.what_helps.sentence");
  return result;
}

const figures::FigureEntry* entry_of(std::string_view name) {
  constexpr std::string_view of_frame = "frame.";
  const auto found = [](std::span<const figures::FigureEntry> entries, std::string_view wanted) {
    const auto at = std::ranges::find(entries, wanted, &figures::FigureEntry::name);
    return at == entries.end() ? nullptr : &*at;
  };
  if (name.starts_with(of_frame)) {
    return found(run::frame_figures(), name.substr(of_frame.size()));
  }
  const figures::FigureEntry* const counted = found(figures::counted_figures(), name);
  return counted != nullptr ? counted : found(figures::derived_figures(), name);
}

}  // namespace

ComparedResult read_run(const std::filesystem::path& path, const std::string& name) {
  return compared(tables::read_run_json(path), name);
}

ComparedResult read_point(const sweep::SweepReader& sweep, std::int64_t ordinal, const std::string& name) {
  return compared(sweep::point_result(sweep, ordinal, name), name);
}

void add_counters(const sweep::SweepRow& row, Figures& figures) {
  figures::for_each_count(figures::counted_figures(), row.counters,
                          [&figures](const std::string& name, std::int64_t value) { figures[name] = value; });
}

void add_frame(const sweep::FrameRow& row, ComparedResult& result) {
  Figures& figures = result.figures;
  result.scene_hash = row.scene_hash;
  figures["frame.scene"] = row.scene;
  figures["frame.image_hash"] = row.image_hash;
  figures["frame.hit_hash"] = row.hit_hash;
  figures::for_each_count(
      run::frame_figures(), row.counters,
      [&figures](const std::string& name, std::int64_t value) { figures["frame." + name] = value; });
}

std::optional<std::int64_t> integer_figure(const ComparedResult& result, const std::string& name) {
  const auto at = result.figures.find(name);
  const auto* value = at == result.figures.end() ? nullptr : std::get_if<std::int64_t>(&at->second);
  return value != nullptr ? std::optional(*value) : std::nullopt;
}

std::optional<std::int64_t> frame_time_if_any(const ComparedResult& result) {
  const std::optional<std::int64_t> ticks = integer_figure(result, "end");
  return ticks && *ticks > 0 ? ticks : std::nullopt;
}

std::int64_t frame_time(const ComparedResult& result) {
  const std::optional<std::int64_t> ticks = frame_time_if_any(result);
  if (!ticks) {
    throw sim::UserError(result.name + ": has no frame time (a figure \"end\" above 0)");
  }
  return *ticks;
}

std::string unit_of_figure(std::string_view name) {
  const figures::FigureEntry* const entry = entry_of(name);
  return entry == nullptr ? std::string() : entry->unit;
}

std::string meaning_of_figure(std::string_view name) {
  const figures::FigureEntry* const entry = entry_of(name);
  return entry == nullptr ? std::string() : entry->description;
}

void keep_what_sweeps_have(ComparedResult& result) {
  for (const figures::FigureEntry& entry : figures::derived_figures()) {
    if (entry.formula->is_relative()) {
      result.figures.erase(entry.name);
    }
  }
  std::erase_if(result.settings, [](const auto& setting) {
    return setting.first.starts_with("host_machine.") || setting.first.starts_with("prices.") ||
           setting.first.starts_with("record.");
  });
}

}  // namespace marti::studies::compare
