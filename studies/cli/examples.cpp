#include "studies/cli/examples.h"

#include <array>
#include <string>
#include <string_view>

#include "sim/error.h"
#include "studies/cli/command_tree.h"

namespace marti::studies::cli {

namespace {

struct Examples {
  std::string_view command;  ///< the words that lead to it
  std::array<std::string_view, 2> calls;
};

constexpr std::array<Examples, 26> table = {{
    {"run",
     {"marti run configs/marti.toml",
      "marti run configs/marti.toml --set machine.nodes=64 --set scene.source=mine.glb -o out"}},
    {"explore",
     {"marti explore configs/marti.toml --set image.width=256 --set image.height=256",
      "marti explore mine.toml --port 8080 --no-browser"}},
    {"study",
     {"marti study paper configs/paper.toml -o out/paper", "marti study stability configs/marti.toml"}},
    {"study operations",
     {"marti study operations", "marti study operations --set scene.source=gears:4 -o out/operations"}},
    {"study paper",
     {"marti study paper configs/paper.toml -o out/paper",
      "marti study paper configs/paper.toml --set 'paper.rules=[3,5]' -o out/paper"}},
    {"study frames",
     {"marti study frames configs/animation.toml -o out/frames",
      "marti study frames configs/animation.toml --set frames.count=4 -o out/frames"}},
    {"study error",
     {"marti study error configs/error.toml -o out/error",
      "marti study error configs/error.toml --set image.integrator=path --set scene.source=room:8 -o "
      "out/paths"}},
    {"study stability",
     {"marti study stability configs/marti.toml",
      "marti study stability configs/dram.toml -o out/stability"}},
    {"study suite",
     {"marti study suite configs/suites/default.toml -o out/suite",
      "marti study suite mine.toml --set image.width=256 --set image.height=256 -o out/suite"}},
    {"sweep",
     {"marti sweep configs/sweep-small.toml -o out --best end --budget 10",
      "marti sweep configs/marti.toml --axis machine.nodes=1,4,16 --axis cache.size=4KiB..64KiB*2 -o out"}},
    {"trace",
     {"marti trace configs/marti.toml -o out",
      "marti trace configs/marti.toml --nodes 0-3 --limit 1GiB -o out"}},
    {"memory",
     {"marti memory configs/dram.toml out/requests.csv",
      "marti memory configs/dram.toml stream.trace --outstanding 64 --json"}},
    {"compare",
     {"marti compare out/small-cache out/large-cache",
      "marti compare out/run out/sweep -o out/compared.html"}},
    {"report", {"marti report out", "marti report out/sweep:12 -o point.html --plots plots"}},
    {"config", {"marti config cache", "marti config machine.nodes --json"}},
    {"figures", {"marti figures", "marti figures --markdown"}},
    {"completion", {"marti completion bash", "marti completion zsh"}},
    {"completion bash",
     {"source <(marti completion bash)",
      "marti completion bash > ~/.local/share/bash-completion/completions/marti"}},
    {"completion fish",
     {"marti completion fish | source", "marti completion fish > ~/.config/fish/completions/marti.fish"}},
    {"completion zsh", {"source <(marti completion zsh)", "marti completion zsh > ~/.zfunc/_marti"}},
    {"man", {"marti man | man -l -", "marti man > marti.1"}},
    {"help", {"marti help", "marti help sweep"}},
    {"scene", {"marti scene list", "marti scene info mine.glb"}},
    {"scene list", {"marti scene list", "marti scene list | grep spheres"}},
    {"scene info", {"marti scene info teapot:12", "marti scene info mine.glb --time 1.5"}},
    {"scene export",
     {"marti scene export gears:2 gears.glb", "marti scene export mine.gltf mine.glb --camera top"}},
}};

void add_below(CLI::App& app, const std::string& words) {
  for (CLI::App* command :
       app.get_subcommands([](const CLI::App* below) { return !below->get_name().empty(); })) {
    const std::string name = words.empty() ? command->get_name() : words + " " + command->get_name();
    const Examples* found = nullptr;
    for (const Examples& examples : table) {
      found = examples.command == name ? &examples : found;
    }
    sim::ensure(found != nullptr, "a command has no examples");
    std::string text = "Examples:";
    for (const std::string_view call : found->calls) {
      text += "\n  ";
      text += call;
    }
    command->footer(text);
    add_below(*command, name);
  }
}

}  // namespace

void add_examples(CLI::App& app) { add_below(app, ""); }

}  // namespace marti::studies::cli
