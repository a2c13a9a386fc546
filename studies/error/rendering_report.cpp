// The text of the rendering family of `marti study error`.
#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "studies/error/rendering_tables.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::error {

namespace {

using Lines = std::back_insert_iterator<std::string>;

std::string_view name_of(const RenderingPoint& point) {
  return knob_names[static_cast<std::size_t>(point.setting.knob)];
}

std::string number(double value) { return value == 0.0 ? "0" : fmt::format("{:.2e}", value); }

// Errors span many decades, so they are written in powers of ten.
std::string error_lines(const RenderingStudy& study) {
  std::string text =
      fmt::format("  {:<10}{:<26}{:>10}{:>10}{:>10}{:>10}{:>9}{:>9}{:>11}{:>13}{:>13}\n", "knob", "setting",
                  "rmse", "relative", "relmse", "largest", "changed", "visible", "rays", "visits", "tests");
  const Lines out = std::back_inserter(text);
  for (const RenderingPoint& point : study.points) {
    const RenderingErrors& errors = point.errors;
    fmt::format_to(out, "  {:<10}{:<26}{:>10}{:>10}{:>10}{:>10}{:>8.2f}%{:>9}{:>11}{:>13}{:>13}{}\n",
                   name_of(point), point.setting.name, number(errors.plain.rmse), number(errors.relative),
                   number(errors.rel_mse), number(errors.plain.largest),
                   100.0 * static_cast<double>(errors.plain.changed) /
                       (static_cast<double>(point.setting.render.width) * point.setting.render.height),
                   errors.plain.visible, point.work.all_rays(), point.visits(), point.work.tests,
                   point.below_floor ? "  below the noise of the reference" : "");
  }
  return text;
}

std::string time_lines(const RenderingStudy& study, const tables::Table& times) {
  std::string text = fmt::format("Run time of one thread, median and range of {} (confidence {:.1f} %)\n",
                                 study.points.front().cpu_ms.size(),
                                 100.0 * estimate::median_interval(study.points.front().cpu_ms).confidence);
  text += fmt::format("  {:<10}{:<26}{:>10}{:>10}{:>10}{:>10}  {}\n", "knob", "setting", "ms", "from", "to",
                      "relative", "front");
  for (std::size_t i = 0; i < study.points.size(); ++i) {
    const RenderingPoint& point = study.points[i];
    const estimate::MedianInterval cpu = estimate::median_interval(point.cpu_ms);
    text += fmt::format("  {:<10}{:<26}{:>10.3f}{:>10.3f}{:>10.3f}{:>10}  {}\n", name_of(point),
                        point.setting.name, cpu.median, cpu.low, cpu.high, number(point.errors.relative),
                        times.at(i, "front") == tables::Cell(std::int64_t{1}) ? "*" : "");
  }
  return text;
}

std::string exact_lines(const RenderingStudy& study) {
  std::size_t settings = 0;
  for (const RenderingPoint& point : study.points) {
    settings += point.setting.knob == Knob::exact ? 1 : 0;
  }
  return fmt::format(
      "Exact: {} structures, limits, mailboxes, packets and machines give every bit of the image.\n",
      settings);
}

std::string precision_lines(const RenderingStudy& study) {
  for (const RenderingPoint& point : study.points) {
    if (point.setting.knob == Knob::precision && !point.setting.reference) {
      const RenderingErrors& errors = point.errors;
      return fmt::format(
          "Floats: {} of {} pixels differ, half of these by at most {:.1e} of the image's level; {} "
          "visibly.\n",
          errors.plain.changed, std::uint64_t{point.setting.render.width} * point.setting.render.height,
          errors.median_change, errors.plain.visible);
    }
  }
  return {};
}

}  // namespace

tables::StudyOutput output_of(const RenderingStudy& study) {
  tables::StudyOutput part;
  part.tables = {rendering_error_table(study), rendering_cheapest_table(study)};
  part.host_tables = {rendering_time_table(study), rendering_fastest_table(study)};

  const processors::program::RenderOptions& base = study.plan.base;
  part.report = fmt::format("Error of the renderer on {}, {} x {}, {} a pixel, at most {} in a row\n\n",
                            study.scene, base.width, base.height, tables::counted(base.samples, "sample"),
                            tables::counted(base.max_depth, "ray"));
  part.report += error_lines(study) + "\n";
  for (const std::string& note : study.plan.notes) {
    part.report += "Note: " + note + ".\n";
  }
  part.report += exact_lines(study) + precision_lines(study);
  part.report += fmt::format("Samples: against {} samples, whose own noise has a root mean square of {:.2e}",
                             study.reference_samples, study.noise_floor);
  if (const std::optional<double> exponent = sample_exponent(study)) {
    part.report += *exponent <= -0.005 ? fmt::format("; the error falls as samples^{:.2f}", *exponent)
                                       : "; more samples than these do not make the error smaller";
  }
  part.report += ".\n\n" + tables::text_of(part.tables[1]);
  part.host_report = time_lines(study, part.host_tables[0]) + "\n" + tables::text_of(part.host_tables[1]);
  return part;
}

}  // namespace marti::studies::error
