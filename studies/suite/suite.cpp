#include "studies/suite/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/shown.h"
#include "studies/keys/config_file.h"
#include "studies/keys/frame_keys.h"
#include "studies/progress/progress_line.h"
#include "studies/report/report_command.h"
#include "studies/suite/suite_file.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/store/answers.h"
#include "studies/sweep/sweep.h"
#include "studies/tables/csv.h"
#include "studies/tables/latex.h"
#include "studies/tables/text_units.h"

namespace marti::studies::suite {

namespace {

const sim::Schema& suite_schema() {
  static const sim::Schema schema = [] {
    sim::Schema keys = sweep::sweep_schema();
    keys.free_section("suite", "the baseline and the scenes of `marti study suite`");
    return keys;
  }();
  return schema;
}

sweep::AxisArgument axis_of(const SuiteFile& suite) {
  sweep::AxisArgument axis{*suite_schema().find("scene.source"), {}};
  for (const SuiteScene& scene : suite.scenes) {
    if (scene.missing.empty()) {
      axis.steps.push_back({axis.key, {scene.source}, scene.line, {}});
    }
  }
  return axis;
}

/// The plan of a suite; of a fault of a scene the message says its name.
sweep::SweepPlan plan_over(const sweep::AxisArgument& scenes, sim::Config& config, const SuiteFile& suite) {
  try {
    return sweep::plan_sweep(config, {}, nullptr, {&scenes, 1});
  } catch (const sim::UserError& error) {
    const auto scene = std::ranges::find(suite.scenes, error.place().line, &SuiteScene::line);
    if (scene == suite.scenes.end()) {
      throw;
    }
    throw sim::UserError(sim::place_in_file(config.name(), scene->line, "suite.scene " + scene->name),
                         std::string(error.what()).substr(error.place().text.size() + 2));
  }
}

std::string missing_text(const SuiteFile& suite) {
  std::string text;
  for (const SuiteScene& scene : suite.scenes) {
    if (!scene.missing.empty()) {
      text += fmt::format("left out      {}: {}{}\n", scene.name, scene.missing,
                          scene.found.empty() ? "" : "; found at " + sim::shown(scene.found));
    }
  }
  return text;
}

sweep::SweepPlan plan_of(sim::Config& config, const SuiteFile& suite) {
  if (config.given("scene.source")) {
    config.fail("scene.source", "a suite has its scenes in [[suite.scene]]; leave it out");
  }
  const sweep::AxisArgument scenes = axis_of(suite);
  if (scenes.steps.empty()) {
    throw sim::UserError(suite.place, "none of the suite's scenes is there");
  }
  sweep::SweepPlan plan = plan_over(scenes, config, suite);
  const auto point = std::ranges::find(plan.axes, "point");
  const auto at = static_cast<std::size_t>(point - plan.axes.begin());
  const auto is_baseline = [&](const sweep::SweepPoint& each) {
    return std::get<std::string>(each.values[at]) == suite.baseline;
  };
  const bool has_both = point != plan.axes.end() && std::ranges::any_of(plan.points, is_baseline) &&
                        !std::ranges::all_of(plan.points, is_baseline);
  if (!has_both) {
    throw sim::UserError(
        suite.place, "there is no other machine, or none of this name: each is a table [sweep.points.NAME]");
  }
  if (plan.directions.size() > 2) {
    throw sim::UserError(suite.place,
                         "a suite crosses scenes and named points, and [sweep] has further axes");
  }
  if (!plan.question.asks.empty()) {
    throw sim::UserError(suite.place, "a suite has its own question; leave out [question]");
  }
  plan.question = question_of(suite);
  return plan;
}

}  // namespace

void suite_command(const SuiteArguments& arguments, void (*print)(const std::string&)) {
  sim::Config config = keys::read_config(suite_schema(), arguments.config, arguments.assignments);
  const SuiteFile suite = read_suite(config);
  print(missing_text(suite));
  const sweep::SweepPlan plan = plan_of(config, suite);
  sweep::check_question(plan.question, plan.axes);
  sweep::SweepOptions options;
  options.directory = arguments.directory;
  options.terminal = progress::errors_go_to_a_terminal();
  options.quiet = arguments.quiet;
  const sweep::SweepReport report = sweep::run_sweep(plan, options, keys::read_memory(config, 1),
                                                     [&](const std::string& text) { print(text); });
  const sweep::Answers answers = sweep::answers_of(*report.reader);
  const std::filesystem::path directory = arguments.directory;
  sim::write_file(directory / "suite.csv", tables::csv_of(answers.tables.front()));
  sim::write_file(directory / "suite.tex", tables::latex_of(answers.tables.front()));
  const std::string timed =
      report.timed == 0 && report.traced == 0
          ? "all of it was there already\n"
          : fmt::format("timed         {} on {}\n", tables::counted(report.timed, "machine"),
                        tables::counted(report.traced, "frame"));
  print(timed + sweep::answer_text(answers) + sweep::tables_text(answers) + "\n" + missing_text(suite) +
        "wrote         " + report.store.string() + "\nwrote         " + report.points.string() +
        "\nwrote         " + (directory / "suite.csv").string() + "\nwrote         " +
        (directory / "suite.tex").string() + "\n");
  // What the page says of the fastest machine is of one scene, and no answer to a suite's question.
  report::report_command({arguments.directory, {}, {}, false, std::nullopt},
                         [](const std::string& /*text*/) {});
  print("wrote         " + (directory / "report.html").string() + "\n");
}

}  // namespace marti::studies::suite
