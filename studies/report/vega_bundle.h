// The scripts that draw charts: Vega, Vega-Lite and Vega's interpreter of expressions, of the versions that
// cmake/npm/package-lock.json pins. The build takes them from npm and puts them into the program.
#pragma once

#include <span>
#include <string_view>

namespace marti::studies {

struct Script {
  std::string_view name;     ///< of its npm package
  std::string_view version;  ///< of its npm package
  std::string_view text;     ///< UTF-8, its licences first; holds no "</script" and no "<!--"
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

}  // namespace marti::studies
