#include "studies/report/chart_library.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "studies/tables/csv.h"
#include "studies/tables/json_table.h"

namespace marti::studies {

ReportChart make_chart(std::string_view specification, const Table& table, const std::string& note) {
  const std::span<const ChartSpecification> all = report_chart_specifications();
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const ChartSpecification& chart) { return chart.name == specification; });
  if (found == all.end()) {
    throw sim::InternalError("there is no chart specification " + std::string(specification));
  }
  ReportChart chart;
  chart.name = table.name();
  chart.title = table.title();
  chart.note = note;
  chart.spec = nlohmann::ordered_json::parse(found->json);
  chart.spec["title"] = table.title();
  chart.spec["data"] = {{"name", "rows"}, {"values", rows_json(table)}};
  chart.csv = csv_of(table);
  return chart;
}

}  // namespace marti::studies
