// Scripts as a page loads them, and those that draw charts: Vega, Vega-Lite and Vega's interpreter of
// expressions, of the versions that cmake/npm/package-lock.json pins. The build takes them from npm and puts
// them into the program.
#pragma once

#include <span>
#include <string_view>

#include "sim/error.h"

namespace marti::studies::report {

/// A script or a style of a page. The build works out its hash, by which the page's policy names it, and sees
/// to it that the text can stand in a page: it holds no "</script" and no "<!--".
struct Script {
  std::string_view text;    ///< UTF-8; of others, their licences first
  std::string_view sha256;  ///< in base64
};

/// In the order in which they are to be loaded. They define the globals vega and vegaLite, and
/// vega.expressionInterpreter for views without eval: vega.parse(spec, config, {ast: true}) and
/// new vega.View(runtime, {expr: vega.expressionInterpreter}). Empty when there are none.
[[nodiscard]] std::span<const Script> vega_scripts();

/// False when the program was built without npm, or with MARTI_REPORT=OFF.
[[nodiscard]] bool have_vega_scripts();

/// The message for a program without the scripts.
inline constexpr const char* no_vega_scripts =
    "this marti was built without the scripts that draw charts; install node and npm (Debian: nodejs, npm), "
    "with "
    "network configure again (cmake --preset release -DMARTI_REPORT=ON says what is missing) and build";

/// Throws the UserError that such a program has no charts.
inline void require_vega_scripts() {
  if (!have_vega_scripts()) {
    throw sim::UserError(no_vega_scripts);
  }
}

// The project's own scripts for charts, in a page and in node.
[[nodiscard]] Script report_chart_style_js();     ///< colours
[[nodiscard]] Script report_explorer_rows_js();   ///< rows of the charts that follow the explorer
[[nodiscard]] Script report_explorer_specs_js();  ///< their specifications

}  // namespace marti::studies::report
