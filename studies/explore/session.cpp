#include "studies/explore/session.h"

#include <algorithm>
#include <array>
#include <new>
#include <optional>

#include <nlohmann/json.hpp>

#include "scenes/open.h"
#include "sim/config.h"
#include "sim/error.h"
#include "sim/nearest.h"
#include "studies/explore/explore_page.h"
#include "studies/explore/modelled_frame.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/config_file.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/price_keys.h"
#include "studies/keys/setting_value.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/page/report_page.h"
#include "studies/report/plots/vega_bundle.h"
#include "studies/report/read/read_report.h"
#include "studies/show/lists.h"
#include "studies/show/result_json.h"

namespace marti::studies::explore {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 9> no_controls = {
    "scene", "frames", "image", "structure", "host_machine", "record", "count", "sweep", "prices"};

std::string section_of(const std::string& key) { return key.substr(0, key.rfind('.')); }

// A text in a value of the configuration that is to hold in any directory.
std::string value_anywhere(const sim::Config& config, const sim::Key& key, std::size_t index) {
  if (key.name == "scene.source" || key.name == "scene.log" || key.name == "image.rays") {
    const auto& source = std::get<std::string>(config.values_at(index).front());
    const std::filesystem::path directory =
        std::filesystem::current_path() / keys::directory_of(config, key.name);
    if (key.name == "scene.source") {
      return sim::print_value(key.type, scenes::source_from(source, directory));
    }
    if (!source.empty()) {
      return sim::print_value(key.type, (directory / source).lexically_normal().string());
    }
  }
  return sim::print_values(key, config.values_at(index));
}

Json key_json(const sim::Config& config, std::size_t index) {
  const sim::Key& key = config.schema().keys()[index];
  return {{"name", key.name},
          {"section", section_of(key.name)},
          {"type", name_of(key.type)},
          {"list", key.is_list},
          {"choices", key.choices},
          {"range", print_range(key)},
          {"minimum", show::json_of_bound(key.minimum)},
          {"maximum", show::json_of_bound(key.maximum)},
          {"unit", key.unit},
          {"meaning", key.meaning},
          {"value", keys::setting_value(key.name, sim::print_values(key, config.values_at(index)))}};
}

std::string keys_json(const sim::Config& config) {
  Json controls = Json::array();
  Json given = Json::object();
  for (std::size_t i = 0; i < config.schema().keys().size(); ++i) {
    const sim::Key& key = config.schema().keys()[i];
    if (is_control(key)) {
      controls.push_back(key_json(config, i));
    }
    if (config.given_at(i)) {
      given[key.name] = value_anywhere(config, key, i);
    }
  }
  Json sections = Json::object();
  for (const sim::Section& section : config.schema().sections()) {
    sections[section.name] = section.meaning;
  }
  Json units = Json::object();
  for (const auto& figures : {figures::counted_figures(), figures::derived_figures()}) {
    for (const figures::FigureEntry& figure : figures) {
      units[figure.name] = figure.unit;
    }
  }
  const Json keys = {{"file", config.name()},
                     {"sections", sections},
                     {"controls", controls},
                     {"units", units},
                     {"given", given}};
  return keys.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// `key`: the one at fault; empty: none.
std::string refusal(const std::string& message, const std::string& key) {
  const Json json = {{"error", message}, {"key", key.empty() ? Json(nullptr) : Json(key)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

bool is_control(const sim::Key& key) {
  const std::string_view section = std::string_view(key.name).substr(0, key.name.find('.'));
  // rt.order is of the frame, which is traced already.
  return std::ranges::find(no_controls, section) == no_controls.end() && key.name != "rt.order";
}

Session::Session(const std::filesystem::path& file, std::vector<std::string> assignments,
                 sim::WorkMeter* meter)
    : assignments_(std::move(assignments)), schema_(run::run_schema()) {
  keys::ConfigText given = keys::read_config_text(file);
  text_ = std::move(given.text);
  name_ = std::move(given.name);
  keys::declare_price_keys(schema_);
  sim::Config config = sim::Config::from_text(schema_, text_, name_, assignments_);
  run::RunOptions options;
  options.prices = keys::read_given_prices(config);
  options.meter = meter;
  functional_ = run::run(config, std::move(options)).functional;
  keys_ = keys_json(config);
  page_ = explore_page(config.name() + ", " + config.text("scene.source"));
}

template <class Make>
std::string Session::refused_or(const Make& make) const {
  try {
    return make();
  } catch (const sim::UserError& error) {
    return refusal(error.what(), schema_.find(error.place().key) ? error.place().key : std::string());
  } catch (const std::bad_alloc&) {
    return refusal("not enough memory for this machine", {});
  }
}

sim::Config Session::config_with(const Settings& settings) const {
  std::vector<std::string> assignments = assignments_;
  for (const auto& [key, value] : settings) {
    const std::optional<std::size_t> index = schema_.find(key);
    // Below, an assignment is cut at its first '=' and trimmed, so a name that is no key might become one
    // there.
    if (!index) {
      throw sim::UserError("--set " + key + "=" + value + ": unknown key" +
                           sim::did_you_mean(key, schema_.names()));
    }
    if (!is_control(schema_.keys()[*index])) {
      throw sim::UserError(sim::Place{"--set " + key + "=" + value, {}, 0, key},
                           "is not a setting of the machine, which are all that the page can change");
    }
    assignments.push_back(key + "=" + value);
  }
  return sim::Config::from_text(schema_, text_, name_, assignments);
}

std::string Session::timed(const Settings& settings, helps::Measuring what_helps,
                           sim::WorkMeter* meter) const {
  sim::Config config = config_with(settings);
  run::RunOptions options;
  options.prices = keys::read_given_prices(config);
  options.what_helps = what_helps;
  options.functional = functional_;
  options.stripped_logs = &stripped_logs_;
  options.meter = meter;
  const run::RunResult result = run::run(config, std::move(options));
  explored_.add(settings, result);
  return show::json_of(result);
}

std::string Session::answer(const Settings& settings, helps::Measuring what_helps,
                            sim::WorkMeter* meter) const {
  return refused_or([&] { return timed(settings, what_helps, meter); });
}

std::string Session::shown(const Settings& settings, helps::Measuring what_helps,
                           sim::WorkMeter* meter) const {
  return refused_or([&] {
    const std::string result = timed(settings, what_helps, meter);
    report::ReportData report = report::report_of_run(tables::RunJson(Json::parse(result), name_));
    if (!report::have_vega_scripts()) {
      report.charts.clear();
    }
    const std::string page = report::page_parts(report).dump(-1, ' ', false, Json::error_handler_t::replace);
    return "{\"result\":" + result + ",\"page\":" + page + "}";
  });
}

std::string Session::modelled(const Settings& settings) const {
  return refused_or([&] {
    sim::Config config = config_with(settings);
    const std::optional<ModelledFrame> frame =
        modelled_frame(*functional_.frame.log, keys::read_machine(config));
    return frame ? Json({{"end", frame->end},
                         {"end_of_one", frame->end_of_one},
                         {"packets", frame->packets},
                         {"of_packets", frame->of_packets}})
                       .dump()
                 : std::string("null");
  });
}

std::optional<std::string> Session::report(const Settings& settings, std::string& refused,
                                           sim::WorkMeter* meter) const {
  bool made = false;
  std::string text = refused_or([&] {
    report::require_vega_scripts();
    const tables::RunJson run(Json::parse(timed(settings, helps::Measuring::within_budget, meter)), name_);
    report::ReportData report = report::report_of_run(run);
    report.title += ", explored";
    const tables::Table machines = explored_.table();
    if (machines.rows().size() > 1) {
      report.charts.insert(report.charts.begin(), report::make_chart("explored", machines));
    }
    report.tables.insert(report.tables.begin(), {machines, false});
    std::string page = report::report_page(report, report::vega_scripts());
    made = true;
    return page;
  });
  if (!made) {
    refused = std::move(text);
    return std::nullopt;
  }
  return text;
}

}  // namespace marti::studies::explore
