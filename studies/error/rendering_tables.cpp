#include "studies/error/rendering_tables.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/mapped.h"
#include "studies/figures/best_offer.h"

namespace marti::studies::error {

namespace {

std::string name_of(Knob knob) { return std::string(knob_names[static_cast<std::size_t>(knob)]); }

std::vector<std::size_t> points_of(const RenderingStudy& study, Knob knob) {
  std::vector<std::size_t> points;
  for (std::size_t i = 0; i < study.points.size(); ++i) {
    if (study.points[i].setting.knob == knob) {
      points.push_back(i);
    }
  }
  return points;
}

// The setting that a knob's errors are measured against: its reference, or else the one of most samples.
std::size_t dearest_of(const RenderingStudy& study, Knob knob) {
  const std::vector<std::size_t> points = points_of(study, knob);
  const auto reference =
      std::ranges::find_if(points, [&](std::size_t point) { return study.points[point].setting.reference; });
  return reference != points.end() ? *reference : points.back();
}

// Where charts draw an error of 0: at least a decade below all others.
double exact_line(const RenderingStudy& study) {
  double least = 1.0;
  for (const RenderingPoint& point : study.points) {
    const double error = known_error(study, point);
    least = error > 0.0 ? std::min(least, error) : least;
  }
  return std::pow(10.0, std::floor(std::log10(least)) - 1.0);
}

tables::Table targets_table(const RenderingStudy& study, std::string name, std::string title,
                            const tables::Column& cost, const std::vector<double>& costs) {
  tables::Table table(
      std::move(name), std::move(title),
      {tables::real_column("target", "fraction", "largest relative error allowed"),
       tables::text_column("knob", "what is turned"),
       tables::text_column("setting", "the cheapest setting that meets the target; none: no value"),
       tables::real_column("error", "fraction", "its root mean square over that of the reference"), cost,
       tables::real_column("gain", "1",
                           "times cheaper than the knob's exact setting (samples: than the most)")});
  for (const double target : rendering_targets) {
    for (std::size_t k = 0; k < knobs; ++k) {
      const auto knob = static_cast<Knob>(k);
      if (knob == Knob::exact || points_of(study, knob).empty()) {
        continue;
      }
      const std::optional<std::size_t> best = cheapest(study, knob, target, costs);
      if (!best) {
        table.add_row({target, name_of(knob), {}, {}, {}, {}});
        continue;
      }
      const RenderingPoint& point = study.points[*best];
      table.add_row({target, name_of(knob), point.setting.name, point.errors.relative,
                     cost.type == tables::ColumnType::integer ? tables::Cell(point.steps())
                                                              : tables::Cell(costs[*best]),
                     costs[dearest_of(study, knob)] / costs[*best]});
    }
  }
  return table;
}

}  // namespace

double known_error(const RenderingStudy& study, const RenderingPoint& point) {
  const bool noisy = point.setting.knob == Knob::samples && study.reference_level > 0.0;
  return std::max(point.errors.relative, noisy ? study.noise_floor / study.reference_level : 0.0);
}

std::vector<double> counted_costs(const RenderingStudy& study) {
  return sim::mapped(study.points,
                     [&](const RenderingPoint& point) { return static_cast<double>(point.steps()); });
}

std::vector<double> timed_costs(const RenderingStudy& study) {
  return sim::mapped(study.points, [&](const RenderingPoint& point) {
    return estimate::median_interval(point.cpu_ms).median;
  });
}

std::vector<std::size_t> front_of(const RenderingStudy& study, Knob knob, const std::vector<double>& costs) {
  std::vector<std::size_t> points = points_of(study, knob);
  // Where pixels are infinite the error is no number, and no point of the front.
  std::erase_if(points,
                [&](std::size_t point) { return std::isnan(known_error(study, study.points[point])); });
  const std::vector<figures::Offer> pairs = sim::mapped(points, [&](const std::size_t point) {
    return figures::Offer{costs[point], known_error(study, study.points[point])};
  });
  return sim::mapped(figures::pareto_front(pairs, figures::Better::lower),
                     [&](const std::size_t index) { return points[index]; });
}

std::optional<std::size_t> cheapest(const RenderingStudy& study, Knob knob, double target,
                                    const std::vector<double>& costs) {
  std::optional<std::size_t> best;
  for (const std::size_t point : points_of(study, knob)) {
    if (known_error(study, study.points[point]) <= target && (!best || costs[point] < costs[*best])) {
      best = point;
    }
  }
  return best;
}

std::optional<double> sample_exponent(const RenderingStudy& study) {
  double n = 0.0;
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  for (const std::size_t i : points_of(study, Knob::samples)) {
    const RenderingPoint& point = study.points[i];
    if (point.setting.render.samples > 1 && !point.below_floor && point.errors.plain.rmse > 0.0) {
      const double log_samples = std::log(point.setting.value);
      const double log_error = std::log(point.errors.plain.rmse);
      n += 1.0;
      x += log_samples;
      y += log_error;
      xx += log_samples * log_samples;
      xy += log_samples * log_error;
    }
  }
  if (n < 2.0) {
    return std::nullopt;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

tables::Table rendering_error_table(const RenderingStudy& study) {
  tables::Table table(
      "rendering_error", "Settings of the renderer: error and counted work",
      {tables::text_column("knob", "what is turned; exact: what must not change the image"),
       tables::text_column("setting", "to what"),
       tables::real_column("value", "1", "the same as a number; 0 for exact"),
       tables::real_column("rmse", "1",
                           "root mean square of the difference from the reference, linear light"),
       tables::real_column("relative", "1", "the same over the root mean square of the reference"),
       tables::real_column("rel_mse", "1", "mean of (x - r)^2 / (r^2 + 0.01)"),
       tables::real_column("largest", "1", "largest difference of a channel"),
       tables::real_column("changed", "fraction", "pixels that differ in any bit"),
       tables::count_column("visible", "pixels with a channel that differs by more than 1/255"),
       tables::real_column("median_change", "1",
                           "of the pixels that differ, the median of the largest difference, relative"),
       tables::count_column("first_column", "of the first pixel that differs, row by row"),
       tables::count_column("first_row", "of the same"),
       tables::real_column("noise", "1", "relative noise of the reference: errors below it are not known"),
       tables::count_column("below_noise", "1: the error is not above that noise"),
       tables::count_column("rays", "rays traced"), tables::count_column("visits", "nodes visited"),
       tables::count_column("tests", "primitives tested")});
  const double noise = study.reference_level > 0.0 ? study.noise_floor / study.reference_level : 0.0;
  for (const RenderingPoint& point : study.points) {
    const RenderingErrors& errors = point.errors;
    const double pixels =
        static_cast<double>(point.setting.render.width) * static_cast<double>(point.setting.render.height);
    const std::uint32_t width = point.setting.render.width;
    table.add_row({name_of(point.setting.knob), point.setting.name, point.setting.value, errors.plain.rmse,
                   errors.relative, errors.rel_mse, errors.plain.largest,
                   static_cast<double>(errors.plain.changed) / pixels, errors.plain.visible,
                   errors.median_change, errors.first ? *errors.first % width : tables::Cell(),
                   errors.first ? *errors.first / width : tables::Cell(),
                   point.setting.knob == Knob::samples ? noise : 0.0, point.below_floor,
                   point.work.all_rays(), point.visits(), point.work.tests});
  }
  return table;
}

tables::Table rendering_cheapest_table(const RenderingStudy& study) {
  return targets_table(study, "rendering_cheapest", "The least counted work for an error of at most ...",
                       tables::count_column("steps", "its rays, visits and tests"), counted_costs(study));
}

tables::Table rendering_fastest_table(const RenderingStudy& study) {
  return targets_table(study, "host_rendering_fastest", "The fastest setting for an error of at most ...",
                       tables::real_column("cpu", "ms", "its run time, the median"), timed_costs(study));
}

tables::Table rendering_time_table(const RenderingStudy& study) {
  tables::Table table(
      "host_rendering_time", "Settings of the renderer: error against run time",
      {tables::text_column("knob", "what is turned; exact: what must not change the image"),
       tables::text_column("setting", "to what"),
       tables::real_column("value", "1", "the same as a number; 0 for exact"),
       tables::real_column("cpu", "ms", "processor time of one thread, the median of the repeats"),
       tables::real_column("cpu_low", "ms", "the shortest"),
       tables::real_column("cpu_high", "ms", "the longest"),
       tables::real_column("confidence", "fraction", "with which the true median lies between these"),
       tables::real_column("relative", "1", "root mean square of the error over that of the reference"),
       tables::real_column("drawn", "1",
                           "the same for a logarithmic axis: no error at a line below all others"),
       tables::real_column("efficiency", "1/ms", "1 / (mean square error x run time); none without error"),
       tables::count_column("front", "1: no other setting of the knob is both faster and better")});
  const std::vector<double> costs = timed_costs(study);
  const double line = exact_line(study);
  std::vector<bool> front(study.points.size());
  for (std::size_t knob = 0; knob < knobs; ++knob) {
    for (const std::size_t point : front_of(study, static_cast<Knob>(knob), costs)) {
      front[point] = true;
    }
  }
  for (std::size_t i = 0; i < study.points.size(); ++i) {
    const RenderingPoint& point = study.points[i];
    const estimate::MedianInterval cpu = estimate::median_interval(point.cpu_ms);
    const double error = known_error(study, point);
    const double square = point.errors.plain.rmse * point.errors.plain.rmse;
    table.add_row({name_of(point.setting.knob), point.setting.name, point.setting.value, cpu.median, cpu.low,
                   cpu.high, cpu.confidence, point.errors.relative, error > 0.0 ? error : line,
                   square > 0.0 ? tables::Cell(1.0 / (square * cpu.median)) : tables::Cell(),
                   bool{front[i]}});
  }
  return table;
}

}  // namespace marti::studies::error
