#include "studies/cli/reference_commands.h"

#include <CLI/CLI.hpp>

#include <span>
#include <string>
#include <vector>

#include "sim/error.h"
#include "sim/mapped.h"
#include "sim/nearest.h"
#include "sim/shown.h"
#include "studies/cli/command_tree.h"
#include "studies/cli/man_page.h"
#include "studies/cli/shell_completion.h"
#include "studies/error/error_keys.h"
#include "studies/keys/combination_table.h"
#include "studies/paper/paper_keys.h"
#include "studies/run/run_result.h"
#include "studies/show/lists.h"
#include "studies/stability/stability.h"
#include "studies/sweep/plan/sweep_keys.h"

namespace marti::studies::cli {

sim::Schema all_keys() {
  sim::Schema schema = run::run_schema();
  paper::declare_paper_keys(schema);
  error::declare_error_keys(schema);
  stability::declare_stability_keys(schema);
  sweep::declare_sweep_keys(schema);
  return schema;
}

namespace {

// What `marti help WORDS` prints. Throws UserError when the words name no command.
std::string help_on(const CLI::App& app, std::span<const std::string> words) {
  const CLI::App* command = &app;
  std::string name = app.get_name();
  for (const std::string& word : words) {
    const CLI::App* const found = find_subcommand(*command, word);
    if (found == nullptr) {
      const std::vector<std::string> names =
          sim::mapped(subcommands_of(*command), [&](const CLI::App* below) { return below->get_name(); });
      throw sim::UserError("help: there is no command \"" + sim::shown(word) + "\"" +
                           sim::did_you_mean(word, names));
    }
    name += " " + found->get_name();
    command = found;
  }
  // CLI::App::help() would be that of the command that was called, which is this one.
  return command->get_formatter()->make_help(command, name, CLI::AppFormatMode::Normal);
}

}  // namespace

void add_reference_commands(CLI::App& app, ReferenceArguments& arguments, void (*print)(const std::string&)) {
  CLI::App* config = app.add_subcommand("config", "Prints every configuration key, or those asked for");
  config->add_option("KEY", arguments.key, "only this key, or the keys of this section")->type_name("KEY");
  CLI::Option* const json = config->add_flag("--json", arguments.json, "as JSON, for programs");
  config->add_flag("--markdown", arguments.markdown, "all, as Markdown, as in docs/configuration.md")
      ->excludes(json);
  config->callback([&arguments, print] {
    if (arguments.markdown) {
      if (!arguments.key.empty()) {
        throw sim::UserError("config: --markdown prints all keys; leave out " + arguments.key);
      }
      print(sim::list_keys_as_markdown(all_keys()) + keys::combinations_as_markdown());
    } else {
      print(arguments.json ? show::keys_as_json(all_keys(), arguments.key)
                           : show::keys_as_text(all_keys(), arguments.key));
    }
  });
  CLI::App* figures = app.add_subcommand("figures", "Prints every figure of a machine and of a frame");
  figures->add_flag("--markdown", arguments.markdown, "as Markdown, as in docs/figures.md");
  figures->callback([&arguments, print] {
    print(arguments.markdown ? show::list_figures_as_markdown() : show::list_figures_as_text());
  });
  CLI::App* completion =
      app.add_subcommand("completion", "Prints the script that completes commands in a shell");
  completion->require_subcommand(1);
  for (const char* shell : {"bash", "fish", "zsh"}) {
    completion->add_subcommand(shell, "for " + std::string(shell))->callback([shell, print] {
      print(std::string(completion_script(shell)));
    });
  }
  CLI::App* help = app.add_subcommand("help", "Prints what a command takes");
  help->add_option("COMMAND", arguments.command, "the command, in one word or more; all if not given")
      ->type_name("WORD");
  help->callback([&app, &arguments, print] { print(help_on(app, arguments.command)); });
  app.add_subcommand("man", "Prints the manual page, for man(1)")->callback([&app, print] {
    print(man_page(app));
  });
}

}  // namespace marti::studies::cli
