#include "studies/error/simulator_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "studies/figures/best_offer.h"

namespace marti::studies::error {

namespace {

constexpr auto at(estimate::Figure figure) { return static_cast<std::size_t>(figure); }

// Without a value where no case was measured.
tables::Cell measured(const estimate::ErrorSummary& summary, double estimate::ErrorSummary::*figure) {
  return summary.cases > 0 ? tables::Cell(summary.*figure) : tables::Cell();
}

// What is counted of the work of all answers.
struct CountedWork {
  std::uint64_t events = 0;
  std::uint64_t words = 0;
};

CountedWork work_of(const SimulatorStudy& study, std::size_t method) {
  CountedWork work;
  for (const std::optional<estimate::Estimate>& estimate : study.estimates[method]) {
    work.events += estimate ? estimate->events : 0;
    work.words += estimate ? estimate->words : 0;
  }
  return work;
}

double median_of(const SimulatorStudy& study, std::size_t method) {
  return estimate::median_interval(study.cpu_seconds[method]).median;
}

const tables::Column method_column = tables::text_column("method", "way of getting the answer");
const tables::Column knob_column = tables::text_column("knob", "its setting");

}  // namespace

tables::Table method_table(const SimulatorStudy& study, std::span<const MethodErrors> errors) {
  tables::Table table(
      "error_methods", "Methods: their errors over all machines, against exact replay",
      {method_column, knob_column, tables::count_column("cases", "machines that it has an answer for"),
       tables::real_column("end_mean", "fraction", "error of the frame time, signed mean"),
       tables::real_column("end_abs", "fraction", "mean of its size"),
       tables::real_column("end_worst", "fraction", "the largest"),
       tables::text_column("worst_case", "where that is"),
       tables::real_column("speed_up_abs", "fraction", "error of the speed-up, mean size"),
       tables::real_column("misses_abs", "fraction", "error of the misses, mean size"),
       tables::real_column(
           "use_abs", "fraction",
           "difference of the share of the frame in which the interconnect is busy, mean size"),
       tables::real_column("wait_abs", "fraction", "error of the mean wait for it, mean size"),
       tables::real_column("tau", "1", "Kendall's tau of the machines by frame time, the lowest of a scene"),
       tables::real_column(
           "regret", "fraction",
           "how much longer a frame the machine chosen has than the best, in the worst scene"),
       tables::real_column("power_regret", "fraction",
                           "how much less speed-up times efficiency, over that of the machine chosen"),
       tables::real_column("covered", "fraction", "share of frame times in the method's own interval"),
       tables::real_column("covered_widened", "fraction",
                           "share in that interval widened by what errors exceed it by on other scenes")});
  const std::span<const estimate::Method> methods = estimate::simulator_methods();
  for (std::size_t m = 0; m < methods.size(); ++m) {
    if (!errors[m].any) {
      continue;
    }
    const auto& figures = errors[m].figures;
    const auto size_of = [&](estimate::Figure figure) {
      return measured(figures[at(figure)].summary, &estimate::ErrorSummary::mean_abs);
    };
    const FigureErrors& end = figures[at(estimate::Figure::end)];
    table.add_row(
        {methods[m].name(), methods[m].knob(), end.summary.cases,
         measured(end.summary, &estimate::ErrorSummary::mean), size_of(estimate::Figure::end),
         measured(end.summary, &estimate::ErrorSummary::worst),
         end.summary.worst == 0.0 ? tables::Cell() : tables::Cell(study.cases[end.summary.worst_case].name),
         size_of(estimate::Figure::speed_up), size_of(estimate::Figure::misses),
         size_of(estimate::Figure::use), size_of(estimate::Figure::wait), errors[m].least_tau,
         errors[m].regret, errors[m].power_regret, end.covered, end.covered_widened});
  }
  return table;
}

tables::Table figure_table(const SimulatorStudy& study, std::span<const MethodErrors> errors) {
  std::vector<tables::Column> columns = {
      method_column,
      knob_column,
      tables::text_column("figure", "what is estimated; use: difference of shares, others: relative"),
      tables::count_column("cases", "machines"),
      tables::real_column("mean", "fraction", "signed mean of the errors"),
      tables::real_column("mean_abs", "fraction", "mean of their sizes"),
      tables::real_column("worst", "fraction", "the largest"),
      tables::text_column("worst_case", "where that is"),
      tables::real_column("covered", "fraction", "share of cases in the method's own 95 % interval"),
      tables::real_column("covered_widened", "fraction",
                          "share in it when widened by what errors exceed it by on other scenes")};
  for (const double use_to : estimate::load_classes) {
    columns.push_back(tables::real_column(
        fmt::format("allowance_{:g}", 100.0 * use_to), "fraction",
        fmt::format("by how much it is to be widened where the interconnect is busy up to {:g} % "
                    "of the frame, more than in the class before",
                    100.0 * use_to)));
  }
  tables::Table table("error_figures", "Figures by every method: errors and intervals", std::move(columns));
  const std::span<const estimate::Method> methods = estimate::simulator_methods();
  for (std::size_t m = 0; m < methods.size(); ++m) {
    for (std::size_t figure = 0; errors[m].any && figure < estimate::figure_count; ++figure) {
      const FigureErrors& found = errors[m].figures[figure];
      std::vector<tables::Cell> row = {methods[m].name(),
                                       methods[m].knob(),
                                       estimate::figure_names[figure],
                                       found.summary.cases,
                                       measured(found.summary, &estimate::ErrorSummary::mean),
                                       measured(found.summary, &estimate::ErrorSummary::mean_abs),
                                       measured(found.summary, &estimate::ErrorSummary::worst),
                                       found.summary.worst == 0.0
                                           ? tables::Cell()
                                           : tables::Cell(study.cases[found.summary.worst_case].name),
                                       found.covered,
                                       found.covered_widened};
      row.insert(row.end(), found.allowance.begin(), found.allowance.end());
      table.add_row(std::move(row));
    }
  }
  return table;
}

tables::Table case_table(const SimulatorStudy& study) {
  std::vector<tables::Column> columns = {
      tables::text_column("machine", "scene, nodes and size of the caches"), method_column, knob_column};
  for (const std::string_view name : estimate::figure_names) {
    const bool ticks = name == "end" || name == "wait";
    columns.push_back(tables::real_column(name,
                                          ticks           ? "ps"
                                          : name == "use" ? "fraction"
                                                          : "1",
                                          "what the method says"));
    columns.push_back(tables::real_column(std::string(name) + "_error", "fraction", "its error"));
    columns.push_back(
        tables::real_column(std::string(name) + "_half_width", "fraction",
                            "of its own 95 % interval, in the error's terms; 0 where it states none"));
  }
  columns.push_back(
      tables::real_column("miss_ratio_error", "fraction",
                          "misses over references, less the same of exact replay: points, not relative"));
  tables::Table table("error_cases", "Every machine by every method", std::move(columns));
  const std::span<const estimate::Method> methods = estimate::simulator_methods();
  for (std::size_t number = 0; number < study.cases.size(); ++number) {
    const estimate::Estimate& truth = study.truth[number];
    const auto miss_ratio = [](const estimate::Estimate& e) {
      return e.references > 0.0 ? e.value[estimate::Figure::misses] / e.references : 0.0;
    };
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const std::optional<estimate::Estimate>& estimate = study.estimates[m][number];
      if (!estimate) {
        continue;
      }
      std::vector<tables::Cell> row = {study.cases[number].name, methods[m].name(), methods[m].knob()};
      for (std::size_t i = 0; i < estimate::figure_count; ++i) {
        const auto figure = static_cast<estimate::Figure>(i);
        row.emplace_back(estimate->value[figure]);
        row.emplace_back(estimate::error_of(figure, estimate->value[figure], truth.value[figure]));
        row.emplace_back(estimate->half_width[figure]);
      }
      row.emplace_back(miss_ratio(*estimate) - miss_ratio(truth));
      table.add_row(std::move(row));
    }
  }
  return table;
}

tables::Table level_table(const SimulatorStudy& study) {
  tables::Table table(
      "error_levels", "Accesses to each level of the octree beside the paper's formula",
      {tables::text_column("scene", "scene"), tables::integer_column("level", "", "the root's is 1"),
       tables::count_column("accesses", "visits to nodes of the level, counted"),
       tables::real_column("from_above", "1", "4 A (B + P) / (B + P + L) of the level above"),
       tables::real_column("above_error", "fraction", "its relative error"),
       tables::real_column("from_root", "1", "the same from the root's accesses down"),
       tables::real_column("root_error", "fraction", "its relative error")});
  for (const LevelAccesses& level : study.levels) {
    const auto counted = static_cast<double>(level.accesses);
    const auto error = [&](double predicted) {
      return counted > 0.0 ? tables::Cell(predicted / counted - 1.0) : tables::Cell();
    };
    table.add_row({level.scene, level.level, level.accesses, level.from_above, error(level.from_above),
                   level.from_root, error(level.from_root)});
  }
  return table;
}

tables::Table time_table(const SimulatorStudy& study, std::span<const MethodErrors> errors) {
  tables::Table table(
      "host_error_time", "Run time beside error",
      {method_column, knob_column, tables::text_column("figure", "whose error is meant"),
       tables::real_column(
           "cpu", "s", "processor time for answers to all machines, tracing included, median of the repeats"),
       tables::real_column("cpu_low", "s", "the least of the repeats"),
       tables::real_column("cpu_high", "s", "the largest"),
       tables::real_column("confidence", "fraction", "that the true median lies between them"),
       tables::real_column("share", "fraction", "processor time over that of exact runs"),
       tables::count_column("events", "events handled"),
       tables::count_column("words", "words of the logs walked"),
       tables::real_column("mean_abs", "fraction", "mean size of the errors"),
       tables::real_column("worst", "fraction", "size of the largest"),
       tables::integer_column("front", "", "1 where no method has both less time and a smaller mean error")});
  const std::span<const estimate::Method> methods = estimate::simulator_methods();
  const double exact = median_of(study, 0);
  for (std::size_t figure = 0; figure < estimate::figure_count; ++figure) {
    std::vector<figures::Offer> points;
    std::vector<std::size_t> of_point;
    for (std::size_t m = 0; m < methods.size(); ++m) {
      if (errors[m].any && errors[m].figures[figure].summary.cases > 0) {
        points.push_back({median_of(study, m), errors[m].figures[figure].summary.mean_abs});
        of_point.push_back(m);
      }
    }
    const std::vector<std::size_t> front = figures::pareto_front(points, figures::Better::lower);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const std::size_t m = of_point[p];
      const estimate::MedianInterval time = estimate::median_interval(study.cpu_seconds[m]);
      const CountedWork work = work_of(study, m);
      const estimate::ErrorSummary& summary = errors[m].figures[figure].summary;
      const bool interpolated = methods[m].kind == estimate::MethodKind::interpolated;
      table.add_row({methods[m].name(), methods[m].knob(), estimate::figure_names[figure], time.median,
                     time.low, time.high, time.confidence,
                     exact > 0.0 ? tables::Cell(time.median / exact) : tables::Cell(),
                     interpolated ? tables::Cell() : work.events, interpolated ? tables::Cell() : work.words,
                     summary.mean_abs, std::abs(summary.worst), std::ranges::find(front, p) != front.end()});
    }
  }
  return table;
}

tables::Table fastest_table(const SimulatorStudy& study, std::span<const MethodErrors> errors) {
  tables::Table table(
      "host_error_fastest", "The fastest method for an error",
      {tables::text_column("figure", "whose error is meant"),
       tables::real_column("error", "fraction", "that is allowed"),
       tables::text_column("by_mean", "the fastest whose mean size of errors is not larger"),
       tables::real_column("mean_share", "fraction", "its processor time over that of exact replay"),
       tables::text_column("by_worst", "the fastest whose largest error is not larger"),
       tables::real_column("worst_share", "fraction", "its processor time over that of exact replay")});
  const std::span<const estimate::Method> methods = estimate::simulator_methods();
  const double exact = median_of(study, 0);
  for (const estimate::Figure figure :
       {estimate::Figure::end, estimate::Figure::speed_up, estimate::Figure::misses, estimate::Figure::use,
        estimate::Figure::wait}) {
    for (const double limit : {0.1, 0.03, 0.01, 0.003, 0.0}) {
      const auto fastest = [&](const auto& size_of) {
        std::size_t best = 0;
        for (std::size_t m = 0; m < methods.size(); ++m) {
          const estimate::ErrorSummary& summary = errors[m].figures[at(figure)].summary;
          if (errors[m].any && summary.cases > 0 && size_of(summary) <= limit &&
              median_of(study, m) < median_of(study, best)) {
            best = m;
          }
        }
        return best;
      };
      const std::size_t by_mean = fastest([](const estimate::ErrorSummary& s) { return s.mean_abs; });
      const std::size_t by_worst = fastest([](const estimate::ErrorSummary& s) { return std::abs(s.worst); });
      const auto text = [&](std::size_t m) { return methods[m].name() + " " + methods[m].knob(); };
      const auto share = [&](std::size_t m) {
        return exact > 0.0 ? tables::Cell(median_of(study, m) / exact) : tables::Cell();
      };
      table.add_row({estimate::figure_names[at(figure)], limit, text(by_mean), share(by_mean), text(by_worst),
                     share(by_worst)});
    }
  }
  return table;
}

tables::Table measured_table(const SimulatorStudy& study) {
  std::vector<tables::Column> columns = {
      tables::integer_column("version", "", "of the list of methods"),
      tables::real_column(
          "use_to", "fraction",
          "machines whose interconnect is busy up to this share of the frame, more than the class before"),
      tables::count_column("windows", "samples of at least so many windows, fewer than the next"),
      tables::count_column("cases", "samples measured"),
      tables::real_column(
          "covered", "fraction",
          "share of them in intervals widened by what the other scenes say, of the figure of which it is "
          "least")};
  for (const std::string_view name : estimate::figure_names) {
    columns.push_back(tables::real_column(
        name, "fraction", "half-width to add to a sample's own, so that 95 % of errors are covered"));
  }
  tables::Table table("error_measured", "Measured errors that `marti run --within` rests on",
                      std::move(columns));
  for (const estimate::MeasuredError& error : measured_errors_of(study)) {
    std::vector<tables::Cell> row = {estimate::methods_version, error.use_to, error.windows, error.cases,
                                     error.covered};
    for (std::size_t i = 0; i < estimate::figure_count; ++i) {
      row.emplace_back(error.allowance[static_cast<estimate::Figure>(i)]);
    }
    table.add_row(std::move(row));
  }
  return table;
}

}  // namespace marti::studies::error
