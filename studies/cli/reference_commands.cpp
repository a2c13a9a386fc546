#include "studies/cli/reference_commands.h"

#include <CLI/CLI.hpp>

#include "studies/cli/man_page.h"
#include "studies/cli/shell_completion.h"
#include "studies/error/error_keys.h"
#include "studies/error/rendering_keys.h"
#include "studies/keys/combination_table.h"
#include "studies/paper/paper_keys.h"
#include "studies/run/run_result.h"
#include "studies/schemes/schemes_keys.h"
#include "studies/show/figure_list.h"
#include "studies/stability/stability_keys.h"
#include "studies/sweep/plan/sweep_keys.h"

namespace marti::studies {

sim::Schema all_keys() {
  sim::Schema schema = run_schema();
  declare_paper_keys(schema);
  declare_schemes_keys(schema);
  declare_error_keys(schema);
  declare_rendering_error_keys(schema);
  declare_stability_keys(schema);
  declare_sweep_keys(schema);
  return schema;
}

void add_reference_commands(CLI::App& app, bool& markdown, void (*print)(const std::string&)) {
  CLI::App* config = app.add_subcommand("config", "Prints every configuration key");
  config->add_flag("--markdown", markdown, "as Markdown, as in docs/configuration.md");
  config->callback([&markdown, print] {
    print(markdown ? sim::list_keys_as_markdown(all_keys()) + combinations_as_markdown()
                   : sim::list_keys_as_text(all_keys()));
  });
  CLI::App* figures = app.add_subcommand("figures", "Prints every figure of a machine and of a frame");
  figures->add_flag("--markdown", markdown, "as Markdown, as in docs/figures.md");
  figures->callback(
      [&markdown, print] { print(markdown ? list_figures_as_markdown() : list_figures_as_text()); });
  CLI::App* completion =
      app.add_subcommand("completion", "Prints the script that completes commands in a shell");
  completion->require_subcommand(1);
  for (const char* shell : {"bash", "zsh"}) {
    completion->add_subcommand(shell, "for " + std::string(shell))->callback([shell, print] {
      print(std::string(completion_script(shell)));
    });
  }
  app.add_subcommand("man", "Prints the manual page, for man(1)")->callback([&app, print] {
    print(man_page(app));
  });
}

}  // namespace marti::studies
