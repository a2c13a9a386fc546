#include "studies/report/model/report_points.h"

#include <algorithm>

#include "studies/tables/cell_number.h"

namespace marti::studies::report {

double ReportAxis::number(std::size_t value) const {
  return tables::number_of(values.at(value)).value_or(0.0);
}

double ReportPoint::figure(std::string_view name) const {
  const auto at = figures.find(name);
  return at == figures.end() ? 0.0 : at->second;
}

std::optional<std::size_t> ReportPoints::axis(std::string_view name) const {
  const auto at = std::ranges::find(axes, name, &ReportAxis::name);
  return at == axes.end() ? std::nullopt : std::optional(static_cast<std::size_t>(at - axes.begin()));
}

}  // namespace marti::studies::report
