#include "studies/cli/shell_completion.h"

#include <CLI/CLI.hpp>

#include <cstddef>
#include <utility>
#include <vector>

#include "scenes/open.h"
#include "scenes/procedural.h"
#include "sim/schema.h"
#include "studies/cli/command_tree.h"
#include "studies/figures/derived_figures.h"
#include "studies/run/plan/plan.h"

namespace marti::studies::cli {

std::string_view bash_completion();
std::string_view fish_completion();
std::string_view zsh_completion();

namespace {

// The candidates that begin as the word does, one a line.
class Candidates {
 public:
  explicit Candidates(std::string_view begun) : begun_(begun) {}

  void add(std::string_view candidate) {
    if (candidate.starts_with(begun_)) {
      text_.append(candidate).push_back('\n');
    }
  }
  // ":files" or ":directories": such names are left to the shell to find.
  void ask_shell(std::string_view directive) { directive_ = directive; }

  [[nodiscard]] std::string text() const { return directive_.empty() ? text_ : text_ + directive_ + '\n'; }

 private:
  std::string_view begun_;
  std::string text_;
  std::string directive_;
};

// A key is offered first, and its values once its '=' is there.
void add_assignments(const sim::Schema& schema, std::string_view begun, Candidates& candidates) {
  const bool has_key = begun.find('=') != std::string_view::npos;
  for (const sim::Key& key : schema.keys()) {
    if (!has_key) {
      candidates.add(key.name + "=");
    } else if (!key.is_list) {
      for (const std::string& choice : key.choices) {
        candidates.add(key.name + "=" + choice);
      }
      if (key.type == sim::ValueType::boolean) {
        candidates.add(key.name + "=true");
        candidates.add(key.name + "=false");
      }
    }
  }
}

// What an argument of this type may be; the types are those that the help shows.
void add_values(std::string_view type, const sim::Schema& schema, std::string_view begun,
                Candidates& candidates) {
  // A set of words, as CLI::IsMember shows it: "TEXT:{din}".
  if (const std::size_t open = type.find('{'); open != std::string_view::npos) {
    std::string_view members = type.substr(open + 1, type.find('}') - open - 1);
    while (!members.empty()) {
      const std::size_t comma = members.find(',');
      candidates.add(members.substr(0, comma));
      members = comma == std::string_view::npos ? std::string_view() : members.substr(comma + 1);
    }
  } else if (type == "KEY=VALUE" || type == "KEY=VALUES") {
    add_assignments(schema, begun, candidates);
  } else if (type == "KEY") {
    for (const sim::Key& key : schema.keys()) {
      candidates.add(key.name);
    }
  } else if (type == "SCENE") {
    for (const scenes::ProceduralScene& scene : scenes::procedural_scenes()) {
      candidates.add(std::string(scene.name) + ":" + std::to_string(scene.default_size));
    }
    std::string files = ":files";
    for (const std::string_view ending : scenes::file_endings) {
      files += " " + std::string(ending);
    }
    candidates.ask_shell(files);
  } else if (type == "ITEM") {
    candidates.add("all");
    for (const std::string_view item : run::plan_item_names) {
      candidates.add(item);
    }
  } else if (type == "METRIC") {
    for (const auto& figures : {figures::derived_figures(), figures::counted_figures()}) {
      for (const figures::FigureEntry& figure : figures) {
        candidates.add(figure.name);
      }
    }
  } else if (type == "DIR") {
    candidates.ask_shell(":directories");
  } else if (type.starts_with("FILE.")) {
    candidates.ask_shell(":files " + std::string(type.substr(5)));
  } else if (type == "FILE" || type == "RESULT") {
    candidates.ask_shell(":files");
  }
}

const CLI::Option* find_option(const CLI::App& command, const std::string& word) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional() && option->check_name(word)) {
      return option;
    }
  }
  return nullptr;
}

// The command that the words lead to, the option whose value comes next, and the positional arguments given.
struct Place {
  const CLI::App* command = nullptr;
  const CLI::Option* awaiting = nullptr;
  std::size_t positionals = 0;
};

Place place_after(const CLI::App& app, std::span<const std::string> words) {
  Place place{&app};
  for (const std::string& word : words) {
    if (place.awaiting != nullptr) {
      place.awaiting = nullptr;
    } else if (word.starts_with('-')) {
      const CLI::Option* option = find_option(*place.command, word);
      place.awaiting = option != nullptr && takes_value(*option) ? option : nullptr;
    } else if (const CLI::App* subcommand = find_subcommand(*place.command, word); subcommand != nullptr) {
      place = {subcommand};
    } else {
      ++place.positionals;
    }
  }
  return place;
}

}  // namespace

std::string_view completion_script(std::string_view shell) {
  if (shell == "bash") {
    return bash_completion();
  }
  if (shell == "fish") {
    return fish_completion();
  }
  return shell == "zsh" ? zsh_completion() : std::string_view();
}

std::string completions(const CLI::App& app, const sim::Schema& schema, std::span<const std::string> words) {
  if (words.empty()) {
    return "";
  }
  const std::string& begun = words.back();
  const Place place = place_after(app, words.first(words.size() - 1));
  Candidates candidates(begun);
  if (place.awaiting != nullptr) {
    add_values(place.awaiting->get_type_name(), schema, begun, candidates);
    return candidates.text();
  }
  if (!begun.starts_with('-')) {
    for (const CLI::App* subcommand : subcommands_of(*place.command)) {
      candidates.add(subcommand->get_name());
    }
    std::size_t position = 0;
    for (const CLI::Option* option : place.command->get_options()) {
      if (!option->nonpositional() && option->get_type_name() == "WORD") {
        for (const CLI::App* other : subcommands_of(app)) {
          candidates.add(other->get_name());
        }
      } else if (!option->nonpositional() && position++ == place.positionals) {
        add_values(option->get_type_name(), schema, begun, candidates);
      }
    }
  } else {
    for (const CLI::Option* option : place.command->get_options()) {
      for (const std::string& name : option->get_lnames()) {
        candidates.add("--" + name);
      }
      for (const std::string& name : option->get_snames()) {
        candidates.add("-" + name);
      }
    }
  }
  return candidates.text();
}

}  // namespace marti::studies::cli
