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

tables::Cell optional_cell(const std::optional<double>& value) {
  return value ? tables::Cell(*value) : tables::Cell();
}

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

const tables::Column method_column = {"method", tables::ColumnType::text, "", "way of getting the answer"};
const tables::Column knob_column = {"knob", tables::ColumnType::text, "", "its setting"};

}  // namespace

tables::Table method_table(const SimulatorStudy& study, std::span<const MethodErrors> errors) {
  tables::Table table(
      "error_methods", "Methods: their errors over all machines, against exact replay",
      {method_column,
       knob_column,
       {"cases", tables::ColumnType::integer, "1", "machines that it has an answer for"},
       {"end_mean", tables::ColumnType::real, "fraction", "error of the frame time, signed mean"},
       {"end_abs", tables::ColumnType::real, "fraction", "mean of its size"},
       {"end_worst", tables::ColumnType::real, "fraction", "the largest"},
       {"worst_case", tables::ColumnType::text, "", "where that is"},
       {"speed_up_abs", tables::ColumnType::real, "fraction", "error of the speed-up, mean size"},
       {"misses_abs", tables::ColumnType::real, "fraction", "error of the misses, mean size"},
       {"use_abs", tables::ColumnType::real, "fraction",
        "difference of the share of the frame in which the interconnect is busy, mean size"},
       {"wait_abs", tables::ColumnType::real, "fraction", "error of the mean wait for it, mean size"},
       {"tau", tables::ColumnType::real, "1",
        "Kendall's tau of the machines by frame time, the lowest of a scene"},
       {"regret", tables::ColumnType::real, "fraction",
        "how much longer a frame the machine chosen has than the best, in the worst scene"},
       {"power_regret", tables::ColumnType::real, "fraction",
        "how much less speed-up times efficiency, over that of the machine chosen"},
       {"covered", tables::ColumnType::real, "fraction", "share of frame times in the method's own interval"},
       {"covered_widened", tables::ColumnType::real, "fraction",
        "share in that interval widened by what errors exceed it by on other scenes"}});
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
        {methods[m].name(), methods[m].knob(), tables::count_cell(end.summary.cases),
         measured(end.summary, &estimate::ErrorSummary::mean), size_of(estimate::Figure::end),
         measured(end.summary, &estimate::ErrorSummary::worst),
         end.summary.worst == 0.0 ? tables::Cell() : tables::Cell(study.cases[end.summary.worst_case].name),
         size_of(estimate::Figure::speed_up), size_of(estimate::Figure::misses),
         size_of(estimate::Figure::use), size_of(estimate::Figure::wait), errors[m].least_tau,
         errors[m].regret, errors[m].power_regret, optional_cell(end.covered),
         optional_cell(end.covered_widened)});
  }
  return table;
}

tables::Table figure_table(const SimulatorStudy& study, std::span<const MethodErrors> errors) {
  std::vector<tables::Column> columns = {
      method_column,
      knob_column,
      {"figure", tables::ColumnType::text, "",
       "what is estimated; use: difference of shares, others: relative"},
      {"cases", tables::ColumnType::integer, "1", "machines"},
      {"mean", tables::ColumnType::real, "fraction", "signed mean of the errors"},
      {"mean_abs", tables::ColumnType::real, "fraction", "mean of their sizes"},
      {"worst", tables::ColumnType::real, "fraction", "the largest"},
      {"worst_case", tables::ColumnType::text, "", "where that is"},
      {"covered", tables::ColumnType::real, "fraction", "share of cases in the method's own 95 % interval"},
      {"covered_widened", tables::ColumnType::real, "fraction",
       "share in it when widened by what errors exceed it by on other scenes"}};
  for (const double use_to : estimate::load_classes) {
    columns.push_back(
        {fmt::format("allowance_{:g}", 100.0 * use_to), tables::ColumnType::real, "fraction",
         fmt::format("by how much it is to be widened where the interconnect is busy up to {:g} % "
                     "of the frame, more than in the class before",
                     100.0 * use_to)});
  }
  tables::Table table("error_figures", "Figures by every method: errors and intervals", std::move(columns));
  const std::span<const estimate::Method> methods = estimate::simulator_methods();
  for (std::size_t m = 0; m < methods.size(); ++m) {
    for (std::size_t figure = 0; errors[m].any && figure < estimate::figure_count; ++figure) {
      const FigureErrors& found = errors[m].figures[figure];
      std::vector<tables::Cell> row = {methods[m].name(),
                                       methods[m].knob(),
                                       std::string(estimate::figure_names[figure]),
                                       tables::count_cell(found.summary.cases),
                                       measured(found.summary, &estimate::ErrorSummary::mean),
                                       measured(found.summary, &estimate::ErrorSummary::mean_abs),
                                       measured(found.summary, &estimate::ErrorSummary::worst),
                                       found.summary.worst == 0.0
                                           ? tables::Cell()
                                           : tables::Cell(study.cases[found.summary.worst_case].name),
                                       optional_cell(found.covered),
                                       optional_cell(found.covered_widened)};
      for (const std::optional<double>& allowance : found.allowance) {
        row.push_back(optional_cell(allowance));
      }
      table.add_row(std::move(row));
    }
  }
  return table;
}

tables::Table case_table(const SimulatorStudy& study) {
  std::vector<tables::Column> columns = {
      {"machine", tables::ColumnType::text, "", "scene, nodes and size of the caches"},
      method_column,
      knob_column};
  for (const std::string_view name : estimate::figure_names) {
    const bool ticks = name == "end" || name == "wait";
    columns.push_back({std::string(name), tables::ColumnType::real,
                       ticks           ? "ps"
                       : name == "use" ? "fraction"
                                       : "1",
                       "what the method says"});
    columns.push_back({std::string(name) + "_error", tables::ColumnType::real, "fraction", "its error"});
    columns.push_back({std::string(name) + "_half_width", tables::ColumnType::real, "fraction",
                       "of its own 95 % interval, in the error's terms; 0 where it states none"});
  }
  columns.push_back({"miss_ratio_error", tables::ColumnType::real, "fraction",
                     "misses over references, less the same of exact replay: points, not relative"});
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
      {{"scene", tables::ColumnType::text, "", "scene"},
       {"level", tables::ColumnType::integer, "", "the root's is 1"},
       {"accesses", tables::ColumnType::integer, "1", "visits to nodes of the level, counted"},
       {"from_above", tables::ColumnType::real, "1", "4 A (B + P) / (B + P + L) of the level above"},
       {"above_error", tables::ColumnType::real, "fraction", "its relative error"},
       {"from_root", tables::ColumnType::real, "1", "the same from the root's accesses down"},
       {"root_error", tables::ColumnType::real, "fraction", "its relative error"}});
  for (const LevelAccesses& level : study.levels) {
    const auto counted = static_cast<double>(level.accesses);
    const auto error = [&](double predicted) {
      return counted > 0.0 ? tables::Cell(predicted / counted - 1.0) : tables::Cell();
    };
    table.add_row({level.scene, tables::count_cell(level.level), tables::count_cell(level.accesses),
                   level.from_above, error(level.from_above), level.from_root, error(level.from_root)});
  }
  return table;
}

tables::Table time_table(const SimulatorStudy& study, std::span<const MethodErrors> errors) {
  tables::Table table(
      "host_error_time", "Run time beside error",
      {method_column,
       knob_column,
       {"figure", tables::ColumnType::text, "", "whose error is meant"},
       {"cpu", tables::ColumnType::real, "s",
        "processor time for answers to all machines, tracing included, median of the repeats"},
       {"cpu_low", tables::ColumnType::real, "s", "the least of the repeats"},
       {"cpu_high", tables::ColumnType::real, "s", "the largest"},
       {"confidence", tables::ColumnType::real, "fraction", "that the true median lies between them"},
       {"share", tables::ColumnType::real, "fraction", "processor time over that of exact runs"},
       {"events", tables::ColumnType::integer, "1", "events handled"},
       {"words", tables::ColumnType::integer, "1", "words of the logs walked"},
       {"mean_abs", tables::ColumnType::real, "fraction", "mean size of the errors"},
       {"worst", tables::ColumnType::real, "fraction", "size of the largest"},
       {"front", tables::ColumnType::integer, "",
        "1 where no method has both less time and a smaller mean error"}});
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
      table.add_row({methods[m].name(), methods[m].knob(), std::string(estimate::figure_names[figure]),
                     time.median, time.low, time.high, time.confidence,
                     exact > 0.0 ? tables::Cell(time.median / exact) : tables::Cell(),
                     interpolated ? tables::Cell() : tables::count_cell(work.events),
                     interpolated ? tables::Cell() : tables::count_cell(work.words), summary.mean_abs,
                     std::abs(summary.worst),
                     std::int64_t{std::find(front.begin(), front.end(), p) != front.end()}});
    }
  }
  return table;
}

tables::Table fastest_table(const SimulatorStudy& study, std::span<const MethodErrors> errors) {
  tables::Table table(
      "host_error_fastest", "The fastest method for an error",
      {{"figure", tables::ColumnType::text, "", "whose error is meant"},
       {"error", tables::ColumnType::real, "fraction", "that is allowed"},
       {"by_mean", tables::ColumnType::text, "", "the fastest whose mean size of errors is not larger"},
       {"mean_share", tables::ColumnType::real, "fraction", "its processor time over that of exact replay"},
       {"by_worst", tables::ColumnType::text, "", "the fastest whose largest error is not larger"},
       {"worst_share", tables::ColumnType::real, "fraction",
        "its processor time over that of exact replay"}});
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
      table.add_row({std::string(estimate::figure_names[at(figure)]), limit, text(by_mean), share(by_mean),
                     text(by_worst), share(by_worst)});
    }
  }
  return table;
}

tables::Table measured_table(const SimulatorStudy& study) {
  std::vector<tables::Column> columns = {
      {"version", tables::ColumnType::integer, "", "of the list of methods"},
      {"use_to", tables::ColumnType::real, "fraction",
       "machines whose interconnect is busy up to this share of the frame, more than the class before"},
      {"windows", tables::ColumnType::integer, "1",
       "samples of at least so many windows, fewer than the next"},
      {"cases", tables::ColumnType::integer, "1", "samples measured"},
      {"covered", tables::ColumnType::real, "fraction",
       "share of them in intervals widened by what the other scenes say, of the figure of which it is "
       "least"}};
  for (const std::string_view name : estimate::figure_names) {
    columns.push_back({std::string(name), tables::ColumnType::real, "fraction",
                       "half-width to add to a sample's own, so that 95 % of errors are covered"});
  }
  tables::Table table("error_measured", "Measured errors that `marti run --within` rests on",
                      std::move(columns));
  for (const estimate::MeasuredError& error : measured_errors_of(study)) {
    std::vector<tables::Cell> row = {std::int64_t{estimate::methods_version}, error.use_to,
                                     static_cast<std::int64_t>(error.windows),
                                     tables::count_cell(error.cases), error.covered};
    for (std::size_t i = 0; i < estimate::figure_count; ++i) {
      row.emplace_back(error.allowance[static_cast<estimate::Figure>(i)]);
    }
    table.add_row(std::move(row));
  }
  return table;
}

}  // namespace marti::studies::error
