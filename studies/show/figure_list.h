// The catalogue of figures as `marti figures` prints it, and as docs/figures.md has it.
#pragma once

#include <string>

namespace marti::studies::show {

[[nodiscard]] std::string list_figures_as_text();
[[nodiscard]] std::string list_figures_as_markdown();

}  // namespace marti::studies::show
