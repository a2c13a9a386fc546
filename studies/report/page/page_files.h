// The files of studies/report/page, built into the program.
#pragma once

#include <string_view>

#include "studies/report/plots/vega_bundle.h"

namespace marti::studies::report {

[[nodiscard]] std::string_view report_page_html();  ///< with {{names}} where something is put in
[[nodiscard]] Script report_page_css();
// Scripts.
[[nodiscard]] Script report_theme_js();
[[nodiscard]] Script report_tooltip_js();
[[nodiscard]] Script report_charts_js();
[[nodiscard]] Script report_address_js();
[[nodiscard]] Script report_points_filter_js();
[[nodiscard]] Script report_points_table_js();
[[nodiscard]] Script report_chosen_point_js();
[[nodiscard]] Script report_controls_js();
[[nodiscard]] Script report_explorer_js();
[[nodiscard]] Script report_sorting_js();
[[nodiscard]] Script report_numbers_js();
[[nodiscard]] Script report_main_js();

}  // namespace marti::studies::report
