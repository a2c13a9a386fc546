// What may come next on the command line, for the completion of bash and zsh. The shells ask the program
// itself, so their scripts (completion/) know none of its commands, options and keys.
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

namespace marti::studies {

/// The script for "bash" or "zsh"; empty for another name.
[[nodiscard]] std::string_view completion_script(std::string_view shell);

/// What may stand in the place of the last of `words`, which is begun or empty, when the others stand before
/// it: one candidate a line, in a fixed order. A candidate that ends in '=' goes on. A last line `:files`,
/// followed by the endings that fit, or `:directories` says that such names fit too. `words` do not hold the
/// program's own name. Whatever the words are, nothing is thrown: where nothing is known the answer is empty.
[[nodiscard]] std::string completions(const CLI::App& app, const sim::Schema& schema,
                                      std::span<const std::string> words);

}  // namespace marti::studies
