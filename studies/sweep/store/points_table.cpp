#include "studies/sweep/store/points_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/figures/best_offer.h"
#include "studies/figures/derived_figures.h"
#include "studies/sweep/plan/axis_text.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::sweep {

namespace {

struct Row {
  double cost;
  std::vector<tables::Cell> figures;
};

std::vector<Row> rows_of(const SweepReader& reader, std::span<const std::string> names) {
  std::vector<Row> rows;
  reader.for_each_point(names, [&](const StoredPoint& point, std::span<const tables::Cell> cells) {
    if (point.done) {
      rows.push_back({point.cost, {cells.begin(), cells.end()}});
    }
  });
  return rows;
}

tables::Table table_of(std::string name, std::string title, std::span<const std::string> names,
                       std::vector<Row> rows) {
  std::vector<tables::Column> columns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    columns.push_back(point_column(names[i]));
    columns.back().type = is_boolean_axis(names[i])
                              ? tables::ColumnType::boolean
                              : tables::common_type(rows.size(), [&](std::size_t row) -> const tables::Cell& {
                                  return rows[row].figures[i];
                                });
    if (columns.back().type == tables::ColumnType::text) {
      columns.back().unit.clear();  // its text holds the unit
    }
  }
  tables::Table table(std::move(name), std::move(title), columns);
  for (Row& row : rows) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      row.figures[i] = tables::as_type(row.figures[i], columns[i].type);
    }
    table.add_row(std::move(row.figures));
  }
  return table;
}

}  // namespace

tables::Column point_column(const std::string& name) {
  static const std::map<std::string, std::pair<std::string, std::string>> own = {
      {"cost", {"1", "price of the machine, by [prices]"}},
      {"ordinal", {"1", "number of the point in the sweep, from 0"}},
      {"machine", {"", "id of its machine in the store"}},
      {"base", {"", "id of the machine that its speed-up is measured against"}},
      {"point", {"", "name in [sweep.points]"}},
      {"best", {"1", "1 for the best within the budget, 0 for the others"}}};
  tables::Column column = is_axis(name) ? tables::real_column(name, axis_unit(name), "the key " + name)
                                        : tables::real_column(name, "", "computed from the points");
  const auto describe = [&](const std::string& unit, const std::string& description) {
    column.unit = unit;
    column.description = description;
  };
  if (const auto found = own.find(name); found != own.end()) {
    describe(found->second.first, found->second.second);
  }
  for (const auto& figures : {figures::counted_figures(), figures::derived_figures()}) {
    for (const figures::FigureEntry& figure : figures) {
      if (figure.name == name) {
        describe(figure.unit, figure.description);
      }
    }
  }
  return column;
}

tables::Table points_table(const SweepReader& reader) {
  const std::vector<std::string>& names = reader.figures();
  tables::Table table = table_of("points", "Points of the sweep", names, rows_of(reader, names));
  const std::map<std::int64_t, Advice> advice = reader.advice();
  const std::size_t machine = table.column("machine");
  const std::array<tables::Column, 4> columns = {
      {tables::text_column("advice", "what would help the machine most, measured for those that matter"),
       tables::text_column("advice_set", "the settings of that step, as for --set"),
       tables::real_column("advice_saves", "fraction", "of the frame time that it saves"),
       tables::real_column("advice_noise", "fraction",
                           "of the frame time, by which frames with packets in other orders differ")}};
  table.add_columns(columns, [&](std::span<const tables::Cell> row) -> std::vector<tables::Cell> {
    const auto found = advice.find(std::get<std::int64_t>(row[machine]));
    if (found == advice.end()) {
      return std::vector<tables::Cell>(columns.size());
    }
    const auto& [sentence, settings, saves, noise] = found->second;
    return {sentence, settings.empty() ? tables::Cell() : settings, saves, noise};
  });
  return table;
}

std::size_t within_noise(std::span<const double> times, double noise) {
  const double most = (1.0 + noise) * *std::ranges::min_element(times);
  return static_cast<std::size_t>(std::ranges::count_if(times, [&](double time) { return time <= most; })) -
         1;
}

std::optional<Noise> noise_of_fastest(std::optional<double> own, const Noise& of_seeds) {
  const Noise noise = larger({own.value_or(0.0)}, of_seeds);
  return own || noise.of_seeds ? std::optional(noise) : std::nullopt;
}

std::string fastest_noise_text(const Noise& noise, std::size_t others) {
  return fmt::format("{} changes its frame by up to {}, and {} within that", noise.cause(),
                     tables::figure_text(noise.band, "fraction", "-"),
                     others == 0 ? "no other point is"
                     : others == 1
                         ? "1 other point is"
                         : tables::grouped(static_cast<std::int64_t>(others)) + " other points are");
}

std::string fastest_text(const SweepReader& reader) {
  const std::map<std::int64_t, Advice> advice = reader.advice();
  const std::vector<std::string>& axes = reader.axes();
  std::optional<std::pair<double, double>> least;  // of frame time and cost
  const Advice* of_least = nullptr;
  std::vector<double> times;
  std::string text;
  const std::vector<std::string> figures = {"end"};
  reader.for_each_point(figures, [&](const StoredPoint& point, std::span<const tables::Cell> cells) {
    const auto found = advice.find(point.machine);
    const std::optional<double> end = tables::number_of(cells[0]);
    if (end) {
      times.push_back(*end);
    }
    if (found == advice.end() || !end || (least && *least <= std::pair(*end, point.cost))) {
      return;
    }
    least = {*end, point.cost};
    of_least = &found->second;
    text = fmt::format("fastest       {} at a cost of {:g}", tables::figure_text(cells[0], "ps", "-"),
                       point.cost);
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      text += (axis == 0 ? ": " : ", ") + axes[axis] + " = " + axis_text(axes[axis], point.values[axis]);
    }
    text += "\n";
  });
  if (of_least == nullptr) {
    return {};
  }
  if (const std::optional<Noise> noise = noise_of_fastest(of_least->noise, reader.noise_of_seeds())) {
    text += "noise         " + fastest_noise_text(*noise, within_noise(times, noise->band)) + "\n";
  }
  return text + "what helps    " + of_least->sentence + "\n";
}

BestPoints best_points(const SweepReader& reader, const std::string& metric, std::optional<double> budget) {
  std::vector<std::string> names = reader.axes();
  const std::size_t axes = names.size();
  names.insert(names.end(), {"cost", metric});
  const figures::FigureEntry& figure = figures::figure_named(metric);
  const figures::Better better = figure.better;
  std::vector<Row> rows = rows_of(reader, names);
  std::erase_if(rows, [](const Row& row) { return !tables::number_of(row.figures.back()); });
  const std::vector<figures::Offer> offers = sim::mapped(rows, [&](const Row& row) {
    return figures::Offer{row.cost, *tables::number_of(row.figures.back())};
  });
  const std::optional<std::size_t> best = figures::best_within(offers, budget, better);
  if (offers.empty()) {
    throw sim::UserError(fmt::format("{}: no point has the figure {}", reader.file().string(), metric));
  }
  if (!best) {
    const auto by_cost = [](const figures::Offer& a, const figures::Offer& b) { return a.cost < b.cost; };
    throw sim::UserError(
        fmt::format("{}: no point costs at most {:g}; the cheapest that has the figure {} costs {:g}",
                    reader.file().string(), budget.value_or(0.0), metric,
                    std::ranges::min_element(offers, by_cost)->cost));
  }
  std::vector<Row> front;
  std::vector<Row> marked;  // with whether it is the best
  for (const std::size_t index : figures::pareto_front(offers, better)) {
    front.push_back(rows[index]);
    marked.push_back(rows[index]);
    const bool chosen =
        offers[index].cost == offers[*best].cost && offers[index].metric == offers[*best].metric;
    marked.back().figures.emplace_back(std::int64_t{chosen ? 1 : 0});
  }
  std::vector<std::string> marked_names = names;
  marked_names.emplace_back("best");
  // Times that differ in their fourth digit must not look alike.
  const bool time = figure.unit == "ps";
  const auto shown = [&figure](const tables::Cell& cell) {
    return tables::figure_text(cell, figure.unit, "-");
  };
  std::string text = fmt::format("best {}{}: {} at a cost of {:g}:", metric,
                                 budget ? fmt::format(" within {:g}", *budget) : std::string(),
                                 shown(rows[*best].figures.back()), offers[*best].cost);
  for (std::size_t axis = 0; axis < axes; ++axis) {
    text +=
        (axis == 0 ? " " : ", ") + names[axis] + " = " + axis_text(names[axis], rows[*best].figures[axis]);
  }
  tables::Table table =
      table_of("best", "Points that no other beats in cost and " + metric, marked_names, std::move(marked));
  for (Row& row : front) {
    for (std::size_t axis = 0; axis < axes; ++axis) {
      if (!is_boolean_axis(names[axis])) {  // a table puts these in words itself
        row.figures[axis] = axis_text(names[axis], row.figures[axis]);
      }
    }
    if (time) {
      row.figures.back() = shown(row.figures.back());
    }
  }
  text += "\n\n" + studies::tables::text_of(table_of("best", table.title(), names, std::move(front)));
  return {std::move(table), std::move(text)};
}

}  // namespace marti::studies::sweep
