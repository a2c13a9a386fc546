#include "studies/cli/command_error.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include "sim/joined.h"
#include "sim/mapped.h"
#include "sim/nearest.h"
#include "studies/cli/command_tree.h"

namespace marti::studies::cli {

namespace {

bool looks_like_a_file(std::string_view word) { return word.ends_with(".toml"); }

// The subcommand that the words select, the words that lead to it and those that follow it.
struct Reached {
  const CLI::App* command = nullptr;
  std::string name;  // as "scene info"
  std::span<const std::string> rest;
};

Reached reached_by(const CLI::App& app, std::span<const std::string> words) {
  Reached reached{&app, "", words};
  while (!reached.rest.empty()) {
    const CLI::App* found = find_subcommand(*reached.command, reached.rest.front());
    if (found == nullptr) {
      break;
    }
    reached.command = found;
    reached.name += (reached.name.empty() ? "" : " ") + reached.rest.front();
    reached.rest = reached.rest.subspan(1);
  }
  return reached;
}

std::string no_subcommand(const Reached& reached) {
  const std::vector<std::string> names = sim::mapped(
      subcommands_of(*reached.command), [&](const CLI::App* command) { return command->get_name(); });
  const std::string there_are = "there are " + sim::listed(names);
  const std::string where = reached.name.empty() ? "" : reached.name + ": ";
  if (reached.rest.empty()) {
    return where + "which command? " + there_are + "; --help says what they do";
  }
  const std::string& word = reached.rest.front();
  if (looks_like_a_file(word) && reached.name.empty()) {
    return "there is no command \"" + word + "\"; a configuration is run by: marti run " + word;
  }
  return where + "there is no command \"" + word + "\"" + sim::did_you_mean(word, names) + "; " + there_are;
}

// The required positional argument that is missing.
const CLI::Option* missing_argument(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_required() && option->count() == 0) {
      return option;
    }
  }
  return nullptr;
}

std::string missing(const Reached& reached, const CLI::Option& option) {
  std::string text = reached.name + ": ";
  text += option.nonpositional() ? option.get_name() + " " + option.get_type_name() : option.get_name();
  text += " is missing: " + option.get_description();
  if (option.get_type_name() == "FILE.toml") {
    text += ", such as configs/marti.toml";
  }
  return text;
}

std::string unexpected(const Reached& reached, const std::string& word) {
  const std::string text = reached.name + ": unexpected \"" + word + "\"";
  std::vector<std::string> names;
  bool sets_keys = false;
  for (const CLI::Option* option : reached.command->get_options()) {
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
    }
    sets_keys = sets_keys || option->get_type_name() == "KEY=VALUE";
  }
  if (word.starts_with('-')) {
    const std::string name = word.substr(0, word.find('='));
    return text + sim::did_you_mean(name, names) + "; the options are " + sim::listed(names);
  }
  if (sets_keys && word.find('=') != std::string::npos) {
    return text + "; a key is set by: --set " + word;
  }
  if (sets_keys) {
    return text +
           "; a value with a space needs quotation marks, as in --set 'cache.size=16 KiB', and a key its '='";
  }
  return text + "; marti " + reached.name + " --help says what it takes";
}

// Words that no option and no argument took, in the order in which they were given.
std::vector<std::string> leftover(const CLI::App& app, std::span<const std::string> words) {
  const std::vector<std::string> found = app.remaining(true);
  std::vector<std::string> ordered;
  for (const std::string& word : words) {
    if (std::ranges::find(found, word) != found.end()) {
      ordered.push_back(word);
    }
  }
  return ordered;
}

}  // namespace

std::string command_error(const CLI::App& app, const CLI::ParseError& error,
                          std::span<const std::string> words) {
  const Reached reached = reached_by(app, words);
  if (!subcommands_of(*reached.command).empty()) {
    return no_subcommand(reached);
  }
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    if (const CLI::Option* option = missing_argument(*reached.command); option != nullptr) {
      return missing(reached, *option);
    }
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    if (const std::vector<std::string> extra = leftover(app, reached.rest); !extra.empty()) {
      return unexpected(reached, extra.front());
    }
  }
  return reached.name + ": " + error.what();
}

}  // namespace marti::studies::cli
