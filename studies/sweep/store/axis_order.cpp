#include "studies/sweep/store/axis_order.h"

#include <algorithm>
#include <map>

#include "studies/tables/cell_number.h"

namespace marti::studies::sweep {

namespace {

// Numbers before texts; what has no value last. Texts keep their order.
bool before(const tables::Cell& a, const tables::Cell& b) {
  const auto number_a = tables::number_of(a);
  const auto number_b = tables::number_of(b);
  if (number_a && number_b) {
    return *number_a < *number_b;
  }
  const auto rank = [](const tables::Cell& cell) {
    return tables::number_of(cell) ? 0 : std::holds_alternative<std::string>(cell) ? 1 : 2;
  };
  return rank(a) < rank(b);
}

AxisColumn column_of(const std::string& name, std::size_t at,
                     std::span<const std::vector<tables::Cell>> points) {
  AxisColumn column;
  column.name = name;
  std::map<tables::CellValue, std::size_t> places;
  for (const std::vector<tables::Cell>& point : points) {
    if (places.emplace(point[at], 0).second) {
      column.values.push_back(point[at]);
    }
  }
  std::ranges::stable_sort(column.values, before);
  for (std::size_t place = 0; place < column.values.size(); ++place) {
    places[column.values[place]] = place;
  }
  for (const std::vector<tables::Cell>& point : points) {
    column.index.push_back(places.at(point[at]));
  }
  return column;
}

bool follows(const AxisColumn& column, const AxisColumn& leader) {
  std::vector<std::size_t> value(leader.values.size(), column.values.size());
  for (std::size_t i = 0; i < column.index.size(); ++i) {
    std::size_t& known = value[leader.index[i]];
    if (known != column.values.size() && known != column.index[i]) {
      return false;
    }
    known = column.index[i];
  }
  return true;
}

}  // namespace

std::vector<AxisColumn> order_axes(std::span<const std::string> names,
                                   std::span<const std::vector<tables::Cell>> points) {
  std::vector<AxisColumn> columns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    AxisColumn column = column_of(names[i], i, points);
    if (column.values.size() > 1) {
      columns.push_back(std::move(column));
    }
  }
  std::vector<bool> led(columns.size(), false);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t j = 0; j < columns.size() && !led[i]; ++j) {
      const bool leads =
          i != j && !led[j] && follows(columns[i], columns[j]) && (j < i || !follows(columns[j], columns[i]));
      if (leads) {
        led[i] = true;
        columns[j].followers.push_back(columns[i].name);
      }
    }
  }
  std::vector<AxisColumn> axes;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!led[i]) {
      axes.push_back(std::move(columns[i]));
    }
  }
  return axes;
}

}  // namespace marti::studies::sweep
