#include "studies/report/model/run_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sim/error.h"
#include "studies/figures/derived_figures.h"
#include "studies/report/model/answer_text.h"
#include "studies/tables/text_units.h"

namespace marti::studies::report {

namespace {

constexpr double longest = 0x1p63;     // of times, ps
constexpr double most_nodes = 0x1p24;  // of a machine, and so of its clusters
constexpr double most_figure = 1e12;   // of ratios: far beyond any

// Where the largest part of the lost speed-up went, or the largest part of what is gained beyond the number
// of nodes. A part may be negative: a gain over one node.
std::string largest_loss(const tables::RunJson& run) {
  std::pair<std::string, double> largest = {"", 0.0};
  std::pair<std::string, double> least = {"", 0.0};
  double all = 0.0;
  double gained = 0.0;
  for (const std::string_view loss : figures::loss_names) {
    const std::string name(loss);
    const std::optional<double> value =
        run.optional_number("figures.machine.lost_" + name, -most_figure, most_figure);
    if (!value) {
      return {};  // a store of an older format has not all of them
    }
    all += *value;
    gained += std::max(0.0, -*value);
    if (*value > largest.second) {
      largest = {name, *value};
    }
    if (*value < least.second) {
      least = {name, *value};
    }
  }
  constexpr double told = 0.005;  // what is shown as 0.00 is not told
  if (all < -told) {
    return fmt::format("That is more than so many single nodes would do, mostly through {}.",
                       figures::gain_of(least.first));
  }
  if (largest.first.empty() || all <= 0.0) {
    return {};
  }
  return fmt::format("The speed-up is {:.2f} below the number of nodes, most of it ({:.2f}) through {}{}.",
                     all, largest.second, figures::loss_text(largest.first),
                     gained < told ? "" : fmt::format("; {:.2f} are gained elsewhere", gained));
}

std::string bound_sentence(const tables::RunJson& run) {
  const std::optional<double> least =
      run.optional_number("machine.bounds.frame_time_at_least_ps", 0.0, longest);
  const double end = run.required_number("figures.machine.end", 1.0, longest);
  if (!least) {
    return {};
  }
  return fmt::format(
      "With the work shared out as it is, this machine needs at least {} ({}): less waiting could gain "
      "{:.1f} % at most.",
      tables::computed_seconds(*least), words(run.text("machine.bounds.by")),
      100.0 * std::max(0.0, 1.0 - *least / end));
}

std::string saturation_sentence(const tables::RunJson& run) {
  const std::optional<double> nodes =
      run.optional_number("machine.bounds.prediction.saturation_nodes", 0.0, most_figure);
  const std::optional<double> error =
      run.optional_number("machine.bounds.prediction.mean_value_error", -most_figure, most_figure);
  if (!nodes) {
    return {};
  }
  std::string text = fmt::format("The busiest queue of a cluster is full from {:.1f} nodes on", *nodes);
  if (error) {
    text += fmt::format(" (by queueing theory, which is {:+.1f} % off for this frame)", 100.0 * *error);
  }
  return text + ".";
}

}  // namespace

std::string machine_text(const tables::RunJson& run) {
  const double clusters = run.required_number("figures.machine.clusters", 1.0, most_nodes);
  const double nodes = run.required_number("figures.machine.nodes", clusters, most_nodes) / clusters;
  const std::string each = fmt::format("{:.0f} node{}", nodes, nodes == 1.0 ? "" : "s");
  return clusters > 1.0 ? fmt::format("{:.0f} clusters of {}", clusters, each) : each;
}

std::vector<std::string> answer_of(const tables::RunJson& run, const std::string& base) {
  if (run.optional_number("figures.machine.end", 0.0, longest) == 0.0) {
    throw sim::UserError(run.file() +
                         ": the frame takes no time on this machine, so there is nothing to report");
  }
  std::vector<std::string> answer;
  std::string first = fmt::format(
      "A frame takes {} on {}",
      tables::computed_seconds(run.required_number("figures.machine.end", 1.0, longest)), machine_text(run));
  if (const std::optional<double> speed_up =
          run.optional_number("figures.machine.speed_up", 0.0, most_figure)) {
    first += fmt::format(": {:.2f} times as fast as {}, an efficiency of {:.1f} %", *speed_up, base,
                         100.0 * run.required_number("figures.machine.efficiency", 0.0, most_figure));
  }
  answer.push_back(first + ".");
  if (const std::string helps = run.text("machine.what_helps.sentence"); !helps.empty()) {
    answer.push_back("What helps: " + helps + ".");
  }
  for (const std::string& sentence : {largest_loss(run), bound_sentence(run), saturation_sentence(run)}) {
    if (!sentence.empty()) {
      answer.push_back(sentence);
    }
  }
  return answer;
}

}  // namespace marti::studies::report
