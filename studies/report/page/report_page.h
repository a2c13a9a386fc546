// The page of a report: one HTML file that loads nothing.
#pragma once

#include <span>
#include <string>

#include "studies/report/model/report_data.h"
#include "studies/report/page/page_sections.h"
#include "studies/report/plots/vega_bundle.h"

namespace marti::studies::report {

/// Texts of the report are escaped wherever they stand. The page's content security policy allows what is in
/// it and nothing else: scripts and style by their SHA-256, images as data: addresses. Equal data give equal
/// bytes. `scripts` are loaded before the page's own, in this order.
[[nodiscard]] std::string report_page(const ReportData& report, std::span<const Script> scripts);

/// A page with these sections; of `report` only the title and the charts are used.
[[nodiscard]] std::string report_page(const ReportData& report, std::span<const PageSection> parts,
                                      std::span<const Script> scripts);

}  // namespace marti::studies::report
