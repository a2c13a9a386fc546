// What may come next on the command line, for the completion of bash and zsh. The shells ask the program
// itself, so their scripts (marti.bash, marti.zsh) know none of its commands, options and keys.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace marti::sim {
class Schema;
}

namespace marti::studies::cli {

/// The script for "bash" or "zsh"; empty for another name.
[[nodiscard]] std::string_view completion_script(std::string_view shell);

/// The candidates for the last of `words`, which is empty or the beginning of a word; the others stand before
/// it. One candidate a line, in a fixed order. After a candidate that ends in '=' a value follows. A last
/// line `:files`, followed by the endings that fit, or `:directories` says that such names fit too. `words`
/// do not hold the program's own name. Nothing is thrown, whatever the words are: the answer may be empty.
[[nodiscard]] std::string completions(const CLI::App& app, const sim::Schema& schema,
                                      std::span<const std::string> words);

}  // namespace marti::studies::cli
