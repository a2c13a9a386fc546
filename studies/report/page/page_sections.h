// The parts of a report's page that are there without a script.
#pragma once

#include <string>
#include <vector>

#include "studies/report/model/report_data.h"

namespace marti::studies::report {

struct PageSection {
  std::string id;     ///< of the element
  std::string title;  ///< for people
  std::string html;   ///< what it holds
};

/// A chart's place on the page, with its note and the links that save it.
[[nodiscard]] std::string chart_html(const ReportChart& chart);

/// In the order of the page; parts for which the report has no data are left out.
[[nodiscard]] std::vector<PageSection> page_sections(const ReportData& report);

}  // namespace marti::studies::report
