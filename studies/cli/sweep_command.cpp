#include "studies/cli/sweep_command.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "sim/error.h"
#include "sim/files.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/config_file.h"
#include "studies/keys/frame_keys.h"
#include "studies/progress/progress_line.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/ranks/launch.h"
#include "studies/sweep/ranks/ranks.h"
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

sweep::SweepOptions options_of(const SweepArguments& arguments) {
  sweep::SweepOptions options;
  options.directory = arguments.directory;
  options.threads = arguments.threads;
  options.terminal = progress::errors_go_to_a_terminal();
  options.quiet = arguments.quiet;
  return options;
}

// The ranks on one computer share its memory; a limit that the user gives applies to each rank.
sim::MemoryBudget memory_of(const sim::Config& config, const sweep::Ranks* ranks) {
  return keys::read_memory(config, ranks == nullptr ? 1 : ranks->on_this_computer());
}

// Runs a rank other than 0. Its computer may lack the configuration file: rank 0 sends the text. Errors in
// the arguments are reported by rank 0 alone.
void join(sweep::Ranks& ranks, const SweepArguments& arguments) {
  if (arguments.plan_only) {
    return;
  }
  sweep::join_sweep(ranks, options_of(arguments), [&](const std::string& text) {
    sim::Config config =
        sim::Config::from_text(sweep::sweep_schema(), text, arguments.config, arguments.assignments);
    sweep::SweepPlan plan = sweep::plan_sweep(config, arguments.axes);
    return sweep::JoinedSweep{std::move(plan), memory_of(config, &ranks)};
  });
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

}  // namespace

void sweep_command(const SweepArguments& arguments, void (*print)(const std::string&)) {
  std::optional<sweep::Ranks> ranks;
  if (sweep::launched_processes() > 1) {
    ranks.emplace();
    if (ranks->rank() != 0) {
      join(*ranks, arguments);
      return;
    }
  }
  keys::require_config_file(arguments.config);
  sweep::SweepOptions options = options_of(arguments);
  options.ranks = ranks ? &*ranks : nullptr;
  if (ranks) {
    options.configuration = sim::read_file(arguments.config, sim::longest_config);
  }
  sim::Config config =
      ranks ? sim::Config::from_text(sweep::sweep_schema(), options.configuration, arguments.config,
                                     arguments.assignments)
            : sim::Config::from_file(sweep::sweep_schema(), arguments.config, arguments.assignments);
  if (arguments.budget && (!std::isfinite(*arguments.budget) || *arguments.budget < 0.0)) {
    throw sim::UserError("--budget: must be a cost of at least 0");
  }
  if (arguments.budget && arguments.best.empty()) {
    throw sim::UserError("--budget: is for the machines of --best METRIC, which is missing");
  }
  if (arguments.plan_only && (arguments.json || !arguments.best.empty())) {
    throw sim::UserError("--plan: prints the plan, as text; leave out --json and --best");
  }
  if (!arguments.best.empty()) {
    if (figures::figure_named(arguments.best).better == figures::Better::neither) {
      throw sim::UserError(
          "--best: of " + arguments.best +
          " neither a lower nor a higher value is better; `marti figures` says of which it is");
    }
  }
  const std::optional<keys::Prices> prices = keys::read_given_prices(config);
  const sweep::SweepPlan plan = sweep::plan_sweep(config, arguments.axes);
  if (arguments.plan_only) {
    print(sweep::describe(plan, sweep::look_ahead(plan, options)));
    return;
  }
  if (arguments.directory.empty()) {
    throw sim::UserError("-o DIR is missing: the directory of the sweep's results (--plan needs none)");
  }
  const sweep::SweepReport report =
      sweep::run_sweep(plan, options, memory_of(config, options.ranks), prices, [&](const std::string& text) {
        if (!arguments.json) {
          print(text);
        }
      });
  if (arguments.json) {
    print(tables::json_of(arguments.best.empty()
                              ? report.limited->table
                              : sweep::best_points(*report.reader, arguments.best, arguments.budget).front));
    return;
  }
  std::string text = said(report) + report.limited->text;
  text += "wrote         " + report.store.string() + "\n";
  text += "wrote         " + report.points.string() + "\n";
  if (!arguments.best.empty()) {
    text += note_of_frames(plan);
    text += "\n" + sweep::best_points(*report.reader, arguments.best, arguments.budget).text;
  }
  print(text);
}

}  // namespace marti::studies::cli
