#include "studies/suite/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/nearest.h"
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
#include "studies/tables/page_file.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/text_units.h"

namespace marti::studies::suite {

namespace {

constexpr const char* left_out_name = "suite_left_out.csv";  // of an earlier run of the suite

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

std::string left_out_text(const LeftOut& what) {
  return fmt::format("left out      {}{}: {}\n", what.scene, what.machine.empty() ? "" : ", " + what.machine,
                     what.reason);
}

LeftOut missing(const SuiteScene& scene) {
  return {scene.name, "",
          scene.missing + (scene.found.empty() ? "" : "; found at " + sim::shown(scene.found))};
}

// Why a point is left out, without where the configuration and its folder are: wherever a suite is run from
// its tables are the same.
std::string reason_of(std::string reason, const std::string& file, const SuiteScene& scene) {
  const auto drop = [&](const std::string& begin) {
    if (reason.starts_with(begin)) {
      reason.erase(0, begin.size());
    }
  };
  drop(fmt::format("{}:{}: ", file, scene.line));
  drop("scene.source: ");
  const std::string folder = std::filesystem::path(file).parent_path().string();
  drop(folder.empty() ? "" : folder + "/");
  return reason;
}

// What the points of a plan compare.
Compared compared_in(const sweep::SweepPlan& plan, const SuiteFile& suite,
                     std::span<const std::string> machines) {
  const auto axis = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(plan.axes, name) - plan.axes.begin());
  };
  using Cell = std::pair<std::string, std::string>;  // a source and a machine
  const auto cell_of = [&, source = axis("scene.source"),
                        point = axis("point")](const std::vector<sim::Value>& values) {
    return Cell(std::get<std::string>(values[source]), std::get<std::string>(values[point]));
  };
  std::set<Cell> there;
  for (const sweep::SweepPoint& point : plan.points) {
    there.insert(cell_of(point.values));
  }
  std::map<Cell, std::string> reasons;
  for (const sweep::SkippedPoint& point : plan.skipped) {
    reasons[cell_of(point.values)] = point.reason;
  }
  Compared compared;
  std::ranges::copy_if(machines, std::back_inserter(compared.machines), [&](const std::string& machine) {
    return machine != suite.baseline && std::ranges::any_of(suite.scenes, [&](const SuiteScene& scene) {
             return there.contains({scene.source, machine}) || reasons.contains({scene.source, machine});
           });
  });
  for (const SuiteScene& scene : suite.scenes) {
    if (!scene.missing.empty()) {
      compared.left_out.push_back(missing(scene));
      continue;
    }
    const auto why = [&](const std::string& machine) {
      const auto found = reasons.find({scene.source, machine});
      return found == reasons.end() ? std::string("does not pass sweep.filter")
                                    : reason_of(found->second, plan.file, scene);
    };
    const std::string of_baseline = why(suite.baseline);
    if (!there.contains({scene.source, suite.baseline})) {
      const bool of_all = std::ranges::all_of(machines, [&](const std::string& machine) {
        return !there.contains({scene.source, machine}) && why(machine) == of_baseline;
      });
      compared.left_out.push_back(
          {scene.name, of_all ? "" : suite.baseline,
           of_baseline + (of_all ? "" : "; without the baseline nothing is compared")});
      continue;
    }
    compared.scenes.push_back(&scene);
    for (const std::string& machine : compared.machines) {
      if (!there.contains({scene.source, machine})) {
        compared.left_out.push_back({scene.name, machine, why(machine)});
      }
    }
  }
  return compared;
}

// The names in [sweep.points].
std::vector<std::string> machines_of(const sweep::SweepPlan& plan) {
  const auto named =
      std::ranges::find(plan.directions, std::vector<std::string>{"point"}, &sweep::SweepDirection::keys);
  return named == plan.directions.end() ? std::vector<std::string>() : named->steps;
}

sweep::SweepPlan plan_of(sim::Config& config, const SuiteFile& suite, const std::string& directory,
                         void (*print)(const std::string&)) {
  if (config.given("scene.source")) {
    config.fail("scene.source", "a suite has its scenes in [[suite.scene]]; leave it out");
  }
  const sweep::AxisArgument scenes = axis_of(suite);
  const auto fail = [&](const std::string& reason) { throw sim::UserError(suite.place, reason); };
  if (scenes.steps.empty()) {
    for (const SuiteScene& scene : suite.scenes) {
      print(left_out_text(missing(scene)));
    }
    fail("none of the suite's scenes is there");
  }
  sweep::SweepPlan plan = sweep::plan_sweep(config, {}, nullptr, {&scenes, 1}, sweep::Unfit::left_out);
  const std::vector<std::string> machines = machines_of(plan);
  if (std::ranges::find(machines, suite.baseline) == machines.end()) {
    fail("there is no machine of this name" + sim::did_you_mean(suite.baseline, machines) +
         "; each is a table [sweep.points.NAME]");
  }
  if (plan.directions.size() > 2) {
    fail("a suite crosses scenes and named points, and [sweep] has further axes");
  }
  if (!plan.question.asks.empty()) {
    fail("a suite has its own question; leave out [question]");
  }
  plan.study = "suite";
  sweep::leave_out_unfit(plan, directory);
  const Compared compared = compared_in(plan, suite, machines);
  for (const LeftOut& what : compared.left_out) {
    print(left_out_text(what));
  }
  if (compared.machines.empty()) {
    fail(machines.size() == 1 ? "there is no other machine: each is a table [sweep.points.NAME]"
                              : "no other machine passes sweep.filter");
  }
  if (compared.scenes.empty()) {
    fail("the baseline is left out of every scene");
  }
  plan.question = question_of(suite, compared);
  plan.skipped.clear();  // it is told
  return plan;
}

}  // namespace

void suite_command(const SuiteArguments& arguments, void (*print)(const std::string&)) {
  sim::Config config = keys::read_config(suite_schema(), arguments.config, arguments.assignments);
  const SuiteFile suite = read_suite(config);
  const std::filesystem::path directory = arguments.directory;
  const std::filesystem::path page = directory / tables::report_page_name;
  if (tables::is_there(page)) {
    tables::check_page_target(page);
  }
  const sweep::SweepPlan plan = plan_of(config, suite, arguments.directory, print);
  sweep::check_question(plan.question, plan.axes);
  sweep::SweepOptions options;
  options.directory = directory;
  options.terminal = progress::errors_go_to_a_terminal();
  options.quiet = arguments.quiet;
  const sweep::SweepReport report = sweep::run_sweep(plan, options, keys::read_memory(config, 1),
                                                     [&](const std::string& text) { print(text); });
  const sweep::Answers answers = sweep::answers_of(*report.reader);
  std::vector<std::filesystem::path> wrote = {report.store, report.points};
  std::string latex;
  std::error_code ignored;
  std::filesystem::remove(directory / left_out_name, ignored);
  for (const tables::Table& table : answers.tables) {
    wrote.push_back(directory / (table.name() + ".csv"));
    sim::write_file(wrote.back(), tables::csv_of(table));
    latex += tables::latex_of(table);
  }
  wrote.push_back(directory / "suite.tex");
  sim::write_file(wrote.back(), latex);
  std::string text = report.timed == 0 && report.traced == 0
                         ? "all of it was there already\n"
                         : fmt::format("timed         {} on {}\n", tables::counted(report.timed, "machine"),
                                       tables::counted(report.traced, "frame"));
  text += sweep::answer_text(answers) + sweep::tables_text(answers) + "\n";
  for (const std::filesystem::path& file : wrote) {
    text += "wrote         " + file.string() + "\n";
  }
  print(text);
  // What the page says of the fastest machine is of one scene, and no answer to a suite's question.
  report::report_command({arguments.directory, {}, {}, false, std::nullopt},
                         [](const std::string& /*text*/) {});
  print("wrote         " + page.string() + "\n");
}

}  // namespace marti::studies::suite
