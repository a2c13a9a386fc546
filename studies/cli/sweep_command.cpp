#include "studies/cli/sweep_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "sim/error.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/config_file.h"
#include "studies/keys/frame_keys.h"
#include "studies/progress/progress_line.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/share.h"
#include "studies/sweep/store/answers.h"
#include "studies/sweep/store/axis_effects.h"
#include "studies/sweep/store/points_table.h"
#include "studies/sweep/sweep.h"
#include "studies/tables/json_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::cli {

namespace {

std::string said(const sweep::SweepReport& report) {
  if (report.timed == 0 && report.traced == 0) {
    return "all of it was there already\n";
  }
  return fmt::format("timed         {} on {} in {}\n", tables::counted(report.timed, "machine"),
                     tables::counted(report.traced, "frame"), tables::duration_text(report.seconds));
}

// Of a share that was not merged by this process.
std::string said_of_share(const sweep::SweepReport& report) {
  if (report.merged) {
    return "another process has merged all shares\n";
  }
  return (report.store.empty() ? "" : "wrote         " + report.store.string() + "\n") +
         "other shares are not done: the last one merges them, or the same command without --share\n";
}

sweep::SweepOptions options_of(const SweepArguments& arguments) {
  sweep::SweepOptions options;
  options.directory = arguments.directory;
  options.threads = arguments.threads;
  options.terminal = progress::errors_go_to_a_terminal();
  options.quiet = arguments.quiet;
  options.share = arguments.share.empty() ? sweep::share_of_launcher() : sweep::share_named(arguments.share);
  return options;
}

// A machine is not better for a frame of less work.
std::string note_of_frames(const sweep::SweepPlan& plan) {
  std::set<std::size_t> frames;
  for (const sweep::SweepPoint& point : plan.points) {
    frames.insert(plan.machines[point.machine].frame);
  }
  return frames.size() < 2
             ? ""
             : "note: the points have " + std::to_string(frames.size()) +
                   " different frames, which are not equal work; sweep.filter leaves one of them\n";
}

// The axes, those first that change the frame time most; nothing of a single one.
std::string said_of_axes(const sweep::SweepReader& reader) {
  const sweep::AxisEffects effects = sweep::axis_effects(reader);
  return effects.axes.size() < 2
             ? std::string()
             : "matters most  " + sweep::effects_text(effects) + " (frame time, worst by best value)\n";
}

}  // namespace

void sweep_command(const SweepArguments& arguments, void (*print)(const std::string&)) {
  const sweep::SweepOptions options = options_of(arguments);
  sim::Config config = keys::read_config(sweep::sweep_schema(), arguments.config, arguments.assignments);
  if (arguments.budget && arguments.best.empty()) {
    throw sim::UserError("--budget: is for the machines of --best METRIC, which is missing");
  }
  if (arguments.plan_only && (arguments.json || !arguments.best.empty() || !arguments.share.empty())) {
    throw sim::UserError("--plan: prints the plan, as text; leave out --json, --best and --share");
  }
  if (!arguments.best.empty()) {
    figures::require_direction(arguments.best, "--best: ");
  }
  sweep::SweepPlan plan = sweep::plan_sweep(config, arguments.axes);
  sweep::leave_out_unfit(plan, arguments.directory);
  sweep::check_question(plan.question, plan.axes);
  if (arguments.plan_only) {
    if (!options.share || options.share->number == 1) {
      print(sweep::describe(plan, sweep::look_ahead(plan, options)));
    }
    return;
  }
  if (arguments.directory.empty()) {
    throw sim::UserError("-o DIR is missing: the directory of the sweep's results (--plan needs none)");
  }
  const sweep::SweepReport report = sweep::run_sweep(
      plan, options, keys::read_memory(config, sweep::processes_beside()), [&](const std::string& text) {
        if (!arguments.json) {
          print(text);
        }
      });
  if (report.reader == nullptr) {
    if (!arguments.json) {
      print(said(report) + said_of_share(report));
    }
    return;
  }
  const sweep::Answers answers = sweep::answers_of(*report.reader);
  if (arguments.json) {
    nlohmann::ordered_json json = tables::table_json(
        arguments.best.empty() ? sweep::points_table(*report.reader)
                               : sweep::best_points(*report.reader, arguments.best, arguments.budget).front);
    if (!answers.asks.empty()) {
      json["question"] = sweep::answers_json(answers);
    }
    print(tables::json_text(json));
    return;
  }
  std::string text = said(report) + sweep::answer_text(answers) + sweep::fastest_text(*report.reader) +
                     said_of_axes(*report.reader);
  text += "wrote         " + report.store.string() + "\n";
  text += "wrote         " + report.points.string() + "\n";
  text += sweep::tables_text(answers);
  if (!arguments.best.empty()) {
    text += note_of_frames(plan);
    text += "\n" + sweep::best_points(*report.reader, arguments.best, arguments.budget).text;
  }
  print(text);
}

}  // namespace marti::studies::cli
