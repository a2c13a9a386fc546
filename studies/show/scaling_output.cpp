#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "studies/show/result_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;

double ticks(sim::Ticks value) { return static_cast<double>(value); }

// The resource that bounds the frame.
std::string_view binding(const run::RunResult& r) {
  const processors::replay::FrameBounds& bounds = r.bounds;
  const sim::Ticks least = bounds.least();
  if (least == bounds.node_work) {
    return "node_work";
  }
  return least == bounds.interconnect ? "interconnect" : "bank";
}

// Of a speed-up that is larger than the number of nodes.
std::string gain_line(const run::RunResult& r) {
  const auto lost = [&r](std::string_view loss) {
    return r.figure("lost_" + std::string(loss)).value_or(0.0);
  };
  const std::string_view most = *std::ranges::min_element(figures::loss_names, {}, lost);
  return fmt::format("  more than one node can do {} times, mostly through {}\n", r.machine.all_nodes(),
                     figures::gain_of(most));
}

}  // namespace

Json bounds_json(const run::RunResult& r) {
  const processors::replay::FrameBounds& b = r.bounds;
  Json prediction = nullptr;
  if (r.prediction) {
    const processors::replay::Prediction& p = *r.prediction;
    const std::optional<double> saturation = p.network.saturation();
    prediction = {{"cluster", p.cluster},
                  {"reads", p.reads},
                  {"nodes", p.network.customers},
                  {"think_ps", p.network.think},
                  {"demand_ps", p.network.demand()},
                  {"largest_demand_ps", p.network.largest()},
                  {"queues", p.network.demands.size()},
                  {"saturation_nodes", saturation ? Json(*saturation) : Json(nullptr)},
                  {"asymptotic_ps", p.asymptotic_low},
                  {"balanced_job_ps", {p.balanced_low, p.balanced_high}},
                  {"mean_value_ps", p.mean_value},
                  {"mean_value_error", p.mean_value / ticks(r.timed.end) - 1.0},
                  {"exact", p.exact}};
  }
  return {{"frame_time_at_least_ps", b.least()},
          {"by", binding(r)},
          {"node_work_ps", b.node_work},
          {"busiest_node", b.busiest_node},
          {"mean_node_work_ps", b.mean_work},
          {"interconnect_ps", b.interconnect},
          {"bank_ps", b.bank},
          {"prediction", prediction}};
}

std::string loss_lines(const run::RunResult& r) {
  const double n = r.machine.all_nodes();
  const std::optional<double> speed_up = r.figure("speed_up");
  if (n == 1.0 || !speed_up) {
    return "";
  }
  std::string text = fmt::format("\nlost speed-up {:.2f} of {}: n - s, and its share of the nodes' time\n",
                                 n - *speed_up, r.machine.all_nodes());
  for (const std::string_view loss : figures::loss_names) {
    const double part = r.figure("lost_" + std::string(loss)).value_or(0.0);
    text +=
        fmt::format("  {:<14}{:>12.2f} {:>11}\n", figures::loss_text(loss), part, tables::percent(part / n));
  }
  return *speed_up > n ? text + gain_line(r) : text;
}

std::string bound_lines(const run::RunResult& r) {
  const processors::replay::FrameBounds& b = r.bounds;
  if (r.timed.end == 0) {
    return "";
  }
  std::string text = fmt::format(
      "\nbounds        at least {} ({} of the frame time): a node's own work {}", tables::seconds(b.least()),
      tables::rough_percent(ticks(b.least()) / ticks(r.timed.end)), tables::seconds(b.node_work));
  if (b.interconnect > 0) {
    const bool bus = r.machine.interconnect.kind == memory::InterconnectKind::bus &&
                     r.machine.placement != processors::machine::Placement::distributed;
    text += fmt::format(", {} {}", bus ? "the bus" : "a link", tables::seconds(b.interconnect));
  }
  if (b.bank > 0) {
    text += fmt::format(", a bank {}", tables::seconds(b.bank));
  }
  text += "\n";
  if (!r.prediction) {
    return text;
  }
  const processors::replay::Prediction& p = *r.prediction;
  const double off = 100.0 * (p.mean_value / ticks(r.timed.end) - 1.0);
  text += fmt::format("predicted     {} by {}mean value analysis ({}{} %), {} to {} by balanced jobs\n",
                      tables::computed_seconds(p.mean_value), p.exact ? "" : "approximate ",
                      off >= 0.05 ? "+" : "", tables::fixed(off, 1), tables::computed_seconds(p.balanced_low),
                      tables::computed_seconds(p.balanced_high));
  if (const std::optional<double> saturation = p.network.saturation()) {
    text +=
        fmt::format("  saturation  from {:.1f} nodes{}: {} between reads, {} a read in the busiest queue\n",
                    *saturation, r.machine.clusters > 1 ? " a cluster" : "",
                    tables::computed_seconds(p.network.think), tables::computed_seconds(p.network.largest()));
  }
  return text;
}

std::string record_lines(const run::RunResult& r) {
  std::string text;
  if (r.heat_map) {
    for (std::size_t i = 0; i < run::heats; ++i) {
      const run::Legend legend = run::legend_of(r.heat_map->figures(static_cast<run::Heat>(i)));
      text += fmt::format(
          "{}{:<14}{:<6} dark 0, bright {:.0f} or more (1 % of the pixels); mean {:.1f}, most {:.0f}\n",
          i == 0 ? "\n" : "", i == 0 ? "heat map" : "", run::heat_names[i], legend.brightest, legend.mean,
          legend.largest);
    }
  }
  if (r.timeline) {
    text += fmt::format("\ntimeline      {} slices", r.timeline->events());
    if (const std::optional<sim::Ticks> cut = r.timeline->cut_at()) {
      text += fmt::format(
          ", cut there: from {} on it is not complete; raise record.timeline_events or narrow it by "
          "record.timeline_from and record.timeline_to",
          tables::seconds(*cut));
    }
    if (const std::optional<sim::Ticks> cut = r.timeline->path_cut_at()) {
      text += fmt::format(", of the critical path what is before {} is missing", tables::seconds(*cut));
    }
    text += "\n";
  }
  return text;
}

}  // namespace marti::studies::show
