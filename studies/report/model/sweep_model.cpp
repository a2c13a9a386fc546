#include "studies/report/model/sweep_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "processors/cost/accounting.h"
#include "sim/rounded.h"
#include "sim/schema.h"
#include "studies/report/model/digits.h"
#include "studies/sweep/plan/sweep_keys.h"

namespace marti::studies::report {

namespace {

constexpr int samples_a_step = 4;

// The range that a configuration allows for the axis; unlimited if the axis is not a key.
std::pair<double, double> range_of(const ReportAxis& axis, const sim::Schema& schema) {
  const auto number = [](const std::optional<sim::Value>& value, double otherwise) {
    return value ? sim::number_of(*value).value_or(otherwise) : otherwise;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::optional<std::size_t> at = schema.find(axis.name);
  return at ? std::pair(number(schema.keys()[*at].minimum, -infinity),
                        number(schema.keys()[*at].maximum, infinity))
            : std::pair(-infinity, infinity);
}

// Between neighbouring values, and beyond the outer ones by one step as long as the step beside it, within
// the range of the key.
std::vector<double> samples_of(const ReportAxis& axis, const sim::Schema& schema) {
  std::vector<double> values;
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    values.push_back(axis.number(i));
  }
  const auto place = [&](double from, double to, double share) {
    const double x = axis.logarithmic ? std::exp(std::lerp(std::log(from), std::log(to), share))
                                      : std::lerp(from, to, share);
    return axis.integer ? std::round(x) : sim::rounded(x, place_digits);
  };
  const auto [lowest, highest] = range_of(axis, schema);
  std::vector<double> x = values;
  const std::size_t last = values.size() - 1;
  for (int i = 1; i <= samples_a_step; ++i) {
    const double share = static_cast<double>(i) / samples_a_step;
    for (std::size_t step = 0; step < last; ++step) {
      if (i < samples_a_step) {
        x.push_back(place(values[step], values[step + 1], share));
      }
    }
    // A store may have been changed: its own values are shown wherever they are.
    x.push_back(std::max(place(values[0], values[1], -share), std::min(lowest, values[0])));
    x.push_back(
        std::min(place(values[last - 1], values[last], 1.0 + share), std::max(highest, values[last])));
  }
  std::ranges::sort(x);
  x.erase(std::unique(x.begin(), x.end()), x.end());
  // Extrapolation stops at 1 for whole numbers and at 0 for other values, unless the axis itself starts
  // lower.
  const double least = values.front() > 0.0 ? (axis.integer ? 1.0 : 0.0) : values.front();
  std::erase_if(x, [&](double each) { return each < least || (axis.logarithmic && each <= 0.0); });
  return x;
}

// How far a line's own model may go: one step of its own points beyond them.
std::pair<double, double> reach(const LineModel& line, bool logarithmic) {
  const std::span<const PointCounters> points = line.points();
  const auto beyond = [&](double from, double to) { return logarithmic ? to * to / from : 2.0 * to - from; };
  const double low = beyond(points[1].x, points[0].x);
  const double high = beyond(points[points.size() - 2].x, points.back().x);
  constexpr double rounding = 1e-9;
  return {low - std::abs(low) * rounding, high + std::abs(high) * rounding};
}

ModelCurve curve_of(const LineModel& line, const ReportAxis& axis, const AxisModel& model) {
  ModelCurve curve;
  const auto [low, high] = reach(line, axis.logarithmic);
  for (const double x : model.x) {
    std::optional<Modelled>& sample = curve.samples.emplace_back();
    if (x < low || x > high || !model.has_band(line.zone(x))) {
      continue;
    }
    sample = line.at(x);
    sample->end = sim::rounded(sample->end, curve_digits);
    sample->base_end = sim::rounded(sample->base_end, place_digits);
    sample->asymptote = sim::rounded(sample->asymptote, curve_digits);
    if (!std::isfinite(sample->end)) {
      sample.reset();
    }
  }
  if (axis.name == "machine.nodes") {
    if (const std::optional<double> nodes = saturation_nodes(line.points().back())) {
      curve.saturation = sim::rounded(*nodes, curve_digits);
    }
  }
  return curve;
}

}  // namespace

std::string line_key(const ReportPoint& point, std::size_t axis) {
  std::string key;
  for (std::size_t i = 0; i < point.place.size(); ++i) {
    key += (i == 0 ? "" : ",") + (i == axis ? std::string("*") : std::to_string(point.place[i]));
  }
  return key;
}

std::string error_note(const AxisModel* model) {
  if (model == nullptr) {
    return "Only simulated points are shown. A curve needs three points that differ in this axis alone, a "
           "model whose error is not too large, and a sweep that is not too large for a page.";
  }
  const auto said = [&](Zone zone, const std::string& where) {
    const ModelError& error = model->end[static_cast<std::size_t>(zone)];
    if (error.points == 0) {
      return std::string();
    }
    if (!error.is_known()) {
      return fmt::format(" {} it is not shown: it is off by more than a factor of 3.", where);
    }
    return fmt::format(" {}: {:.1f} % on average, 95 % of them below {:.1f} % ({} points left out once).",
                       where, 100.0 * error.mean, 100.0 * error.p95, error.points);
  };
  return "Points are simulated, the curve is modelled. Error of the model's frame times, measured on this "
         "sweep." +
         said(Zone::between, " Between points") + said(Zone::beyond, " One step beyond them");
}

PointCounters counters_of(const ReportPoint& point, double x) {
  using processors::cost::Activity;
  const auto sum = [&](std::initializer_list<Activity> activities) {
    return std::accumulate(activities.begin(), activities.end(), 0.0, [&](double all, Activity activity) {
      const std::string name(processors::cost::activity_names[static_cast<std::size_t>(activity)]);
      return all + point.figure("time_" + name);
    });
  };
  PointCounters counters;
  counters.x = x;
  counters.end = point.figure("end");
  counters.base_end = counters.end * point.figure("speed_up");
  counters.nodes = std::max(1.0, point.figure("nodes"));
  counters.clusters = std::max(1.0, point.figure("clusters"));
  counters.packets = point.figure("packets");
  counters.work = sum({Activity::traversal, Activity::intersection, Activity::shading, Activity::building,
                       Activity::cache_access, Activity::switching, Activity::messaging, Activity::transfer,
                       Activity::bank_access});
  counters.delays = sum({Activity::lock_wait, Activity::message_wait, Activity::dispatch_wait});
  counters.links = 0.0;
  if (point.links_are_queues) {
    counters.reads = point.figure("interconnect_reads");
    counters.links = point.figure("interconnect_links");
    counters.link_busy = point.figure("interconnect_busy");
  }
  if (point.banks_are_queues) {
    counters.banks = point.figure("banks");
    counters.bank_busy = point.figure("bank_busy");
  }
  return counters;
}

std::vector<AxisModel> model_sweep(const ReportPoints& sweep, std::size_t most_samples) {
  const sim::Schema& schema = sweep::sweep_schema();
  std::vector<AxisModel> models;
  std::size_t samples = 0;
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    const ReportAxis& axis = sweep.axes[i];
    if (!axis.numeric) {
      continue;
    }
    std::map<std::string, std::vector<PointCounters>> lines;
    for (const ReportPoint& point : sweep.points) {
      if (point.figure("end") > 0.0) {
        lines[line_key(point, i)].push_back(counters_of(point, axis.number(point.place[i])));
      }
    }
    LeaveOneOut errors;
    std::map<std::string, LineModel> fitted;
    for (auto& [key, points] : lines) {
      if (points.size() >= 2) {
        const LineModel& line =
            fitted.emplace(key, LineModel(std::move(points), axis.logarithmic)).first->second;
        errors.add(line, axis.logarithmic);
      }
    }
    AxisModel model;
    model.axis = i;
    for (const Zone zone : {Zone::between, Zone::beyond}) {
      model.end[static_cast<std::size_t>(zone)] = errors.of_end(zone);
      model.speed_up[static_cast<std::size_t>(zone)] = errors.of_speed_up(zone);
    }
    if (!model.has_band(Zone::between) && !model.has_band(Zone::beyond)) {
      continue;
    }
    model.x = samples_of(axis, schema);
    const std::size_t more = model.x.size() * fitted.size();
    if (samples + more > most_samples) {
      continue;
    }
    samples += more;
    for (const auto& [key, line] : fitted) {
      model.curves.emplace(key, curve_of(line, axis, model));
    }
    models.push_back(std::move(model));
  }
  return models;
}

}  // namespace marti::studies::report
