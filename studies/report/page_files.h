// The files of studies/report/page, built into the program.
#pragma once

#include <string_view>

namespace marti::studies {

[[nodiscard]] std::string_view report_page_html();  ///< with {{names}} where something is put in
[[nodiscard]] std::string_view report_page_css();
// Scripts, in the order in which the page loads them.
[[nodiscard]] std::string_view report_chart_style_js();
[[nodiscard]] std::string_view report_theme_js();
[[nodiscard]] std::string_view report_charts_js();
[[nodiscard]] std::string_view report_explorer_rows_js();
[[nodiscard]] std::string_view report_explorer_js();
[[nodiscard]] std::string_view report_main_js();

}  // namespace marti::studies
