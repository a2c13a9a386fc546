// The page of `marti explore`: that of a report, whose parts follow the machine, and beside them the
// controls.
#pragma once

#include <string>

#include "studies/report/plots/vega_bundle.h"

namespace marti::studies::explore {

/// `what`: configuration and scene, for the title. Without Vega's scripts the page says in the place of
/// charts how to get them.
[[nodiscard]] std::string explore_page(const std::string& what);

// The files of the page, built into the program (studies/CMakeLists.txt).
[[nodiscard]] report::Script explore_page_css();
[[nodiscard]] report::Script explore_state_js();
[[nodiscard]] report::Script explore_server_js();
[[nodiscard]] report::Script explore_values_js();
[[nodiscard]] report::Script explore_sliders_js();
[[nodiscard]] report::Script explore_controls_js();
[[nodiscard]] report::Script explore_answer_js();
[[nodiscard]] report::Script explore_curve_js();
[[nodiscard]] report::Script explore_save_js();
[[nodiscard]] report::Script explore_main_js();

}  // namespace marti::studies::explore
