// The files of the page, built into the program (studies/CMakeLists.txt).
#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace marti::studies::explore {

[[nodiscard]] std::string_view explore_page_html();
[[nodiscard]] std::string_view explore_page_css();
// Scripts.
[[nodiscard]] std::string_view explore_state_js();
[[nodiscard]] std::string_view explore_server_js();
[[nodiscard]] std::string_view explore_values_js();
[[nodiscard]] std::string_view explore_sliders_js();
[[nodiscard]] std::string_view explore_controls_js();
[[nodiscard]] std::string_view explore_answer_js();
[[nodiscard]] std::string_view explore_curve_js();
[[nodiscard]] std::string_view explore_save_js();
[[nodiscard]] std::string_view explore_main_js();

/// Each script and the name by which the page asks for it.
[[nodiscard]] inline std::array<std::pair<std::string_view, std::string_view>, 9> explore_scripts() {
  return {{{"state.js", explore_state_js()},
           {"server.js", explore_server_js()},
           {"values.js", explore_values_js()},
           {"sliders.js", explore_sliders_js()},
           {"controls.js", explore_controls_js()},
           {"answer.js", explore_answer_js()},
           {"curve.js", explore_curve_js()},
           {"save.js", explore_save_js()},
           {"main.js", explore_main_js()}}};
}

}  // namespace marti::studies::explore
