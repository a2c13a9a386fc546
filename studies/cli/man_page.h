// The manual page marti(1), made from the commands and options that the program itself takes.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace marti::studies::cli {

/// The page in the language of man(7). The same program gives the same bytes; the page has no date.
[[nodiscard]] std::string man_page(const CLI::App& app);

}  // namespace marti::studies::cli
