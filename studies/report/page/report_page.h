// The page of a report: one HTML file that loads nothing.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "studies/report/model/report_data.h"
#include "studies/report/page/page_sections.h"
#include "studies/report/plots/vega_bundle.h"

namespace marti::studies::report {

/// Texts of the report are escaped wherever they stand. The page's content security policy allows what is in
/// it and nothing else: scripts and style by their SHA-256, images as data: addresses. Equal data give equal
/// bytes. `scripts` are loaded before the page's own, in this order.
[[nodiscard]] std::string report_page(const ReportData& report, std::span<const Script> scripts);

/// What a page has that talks to a server.
struct LivePage {
  std::vector<Script> scripts;  ///< loaded when all others are there; they may ask the page's own server
  Script style;                 ///< behind the style of every page
};

/// A page with these sections; of `report` only title, what it is about and charts are used.
[[nodiscard]] std::string report_page(const ReportData& report, std::span<const PageSection> parts,
                                      std::span<const Script> scripts,
                                      const std::optional<LivePage>& live = {});

/// What a live page shows anew when its report is another: "about", "answer", a list of sentences, "charts"
/// as the page's own scripts have them (docs/internals/pages.md), and "sections", their HTML by their ids.
[[nodiscard]] nlohmann::ordered_json page_parts(const ReportData& report);

}  // namespace marti::studies::report
