// The completion scripts and the manual page, as the program prints them.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

void expect_in(const std::string& text, const std::string& whole) {
  EXPECT_PRED_FORMAT2(testing::IsSubstring, text, whole);
}

bool has(const std::string& program) { return shell("command -v " + program).status == 0; }

// What bash offers for a line, one candidate a line, as after a TAB at its end.
std::string bash_offers(const std::string& line, const std::filesystem::path& directory = ".") {
  const std::filesystem::path program(MARTI_PROGRAM);
  const Outcome outcome =
      shell("cd " + quoted(directory) + " && PATH=" + quoted(program.parent_path()) +
            ":$PATH bash --norc -c 'source <(marti completion bash); COMP_LINE=\"" + line +
            "\"; COMP_POINT=${#COMP_LINE}; read -ra COMP_WORDS <<<\"$COMP_LINE\"; _marti; "
            "printf \"%s\\n\" \"${COMPREPLY[@]}\"'");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return outcome.output;
}

TEST(BashCompletion, OffersCommandsAndOptions) {
  expect_in("run\nexplore\nstudy\nsweep\n", bash_offers("marti "));
  EXPECT_EQ(bash_offers("marti sw"), "sweep\n");
  EXPECT_EQ(bash_offers("marti study st"), "stability\n");
  EXPECT_EQ(bash_offers("marti run --verify"), "--verify-plan\n");
  EXPECT_EQ(bash_offers("marti scene export --an"), "--animation\n");
}

TEST(BashCompletion, OffersKeysAndTheirValues) {
  EXPECT_EQ(bash_offers("marti run --set cache.wa"), "cache.ways=\n");
  // Behind the '=', where bash begins a word.
  EXPECT_EQ(bash_offers("marti run --set cache.replacement=f"), "fifo\n");
  EXPECT_EQ(bash_offers("marti run --set record.timeline="), "true\nfalse\n");
  EXPECT_EQ(bash_offers("marti run --set cache.size=16"), "\n");
}

TEST(BashCompletion, OffersItemsScenesAndMetrics) {
  EXPECT_EQ(bash_offers("marti run --keep sh"), "shadow-rays\n");
  EXPECT_EQ(bash_offers("marti scene info tea"), "teapot:12\n");
  EXPECT_EQ(bash_offers("marti scene info teapot:"), "12\n");
  EXPECT_EQ(bash_offers("marti sweep --best speed"), "speed_up\n");
}

TEST(BashCompletion, OffersFilesOfTheRightKind) {
  const TemporaryDirectory directory;
  write(directory.path() / "mine.toml", "");
  write(directory.path() / "mine.glb", "");
  std::filesystem::create_directory(directory.path() / "minerals");
  EXPECT_EQ(bash_offers("marti run mi", directory.path()), "mine.toml\nminerals\n");
  EXPECT_EQ(bash_offers("marti scene info mi", directory.path()), "mine.glb\nminerals\n");
  EXPECT_EQ(bash_offers("marti run -o mi", directory.path()), "minerals\n");
}

// Those functions of zsh's completion system that the script uses print their arguments.
std::string zsh_offers(const std::string& line) {
  const std::filesystem::path program(MARTI_PROGRAM);
  const Outcome outcome =
      shell("PATH=" + quoted(program.parent_path()) +
            ":$PATH zsh -f -c 'compdef() { :; }; compadd() { while [[ $1 != -- ]]; do shift; done; shift; "
            "(( $# )) && print -l -- \"$@\"; return 0 }; _files() { print \"files $*\"; }; "
            "source <(marti completion zsh); words=(" +
            line + "); CURRENT=$#words; _marti'");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return outcome.output;
}

TEST(ZshCompletion, OffersTheSame) {
  if (!has("zsh")) {
    GTEST_SKIP() << "there is no zsh";
  }
  EXPECT_EQ(zsh_offers("marti sw"), "sweep\n");
  EXPECT_EQ(zsh_offers("marti run --set cache.wa"), "cache.ways=\n");
  EXPECT_EQ(zsh_offers("marti run --set cache.replacement=f"), "cache.replacement=fifo\n");
  EXPECT_EQ(zsh_offers("marti run -o \"\""), "files -/\n");
  EXPECT_EQ(zsh_offers("marti scene info tea"), "teapot:12\nfiles -g *.(gltf|glb|obj|ply)\n");
}

TEST(FishCompletion, OffersTheSame) {
  if (!has("fish")) {
    GTEST_SKIP() << "there is no fish";
  }
  const std::filesystem::path program(MARTI_PROGRAM);
  const Outcome outcome =
      shell("PATH=" + quoted(program.parent_path()) +
            ":$PATH fish -N -c 'marti completion fish | source; complete -C \"marti sw\"; "
            "complete -C \"marti run --set cache.replacement=f\"'");
  EXPECT_EQ(outcome.output, "sweep\ncache.replacement=fifo\n");
}

TEST(Completion, RefusesOtherShells) {
  const Outcome outcome = marti("completion tcsh");
  EXPECT_EQ(outcome.status, 2);
  expect_in("tcsh", outcome.output);
}

TEST(Completion, OffersAxesAndKeys) {
  EXPECT_EQ(bash_offers("marti sweep --axis cache.wa"), "cache.ways=\n");
  EXPECT_EQ(bash_offers("marti config cache.wa"), "cache.ways\n");
  EXPECT_EQ(bash_offers("marti help swe"), "sweep\n");
}

TEST(Completion, NeverComplains) {
  for (const char* words :
       {"", "''", "nonsense ''", "run --nonsense ''", "-- ''", "run --set '=' ''", "run $'\\377'"}) {
    const Outcome outcome = marti("__complete " + std::string(words));
    EXPECT_EQ(outcome.status, 0) << words << outcome.output;
  }
}

// The words of a help text that are options, and its subcommands.
void expect_on_page(const std::string& page, const std::string& words) {
  const Outcome help = marti(words + " --help");
  ASSERT_EQ(help.status, 0) << words;
  EXPECT_TRUE(words.empty() || help.output.find("\nExamples:\n  ") != std::string::npos) << words;
  static const std::regex option("\n  (?:-[a-zA-Z],)?(--[a-z-]+)");
  for (std::sregex_iterator at(help.output.begin(), help.output.end(), option), end; at != end; ++at) {
    expect_in((*at)[1].str(), page);
  }
  const std::size_t listed = help.output.find("Subcommands:\n");
  if (listed == std::string::npos) {
    expect_in("marti" + words, page);
    return;
  }
  const std::string commands = help.output.substr(listed, help.output.find("\nExamples:") - listed);
  static const std::regex command("\n  ([a-z]+) ");
  for (std::sregex_iterator at(commands.begin(), commands.end(), command), end; at != end; ++at) {
    expect_on_page(page, words + " " + (*at)[1].str());
  }
}

TEST(ManPage, NamesEveryCommandAndOption) {
  const Outcome page = marti("man");
  ASSERT_EQ(page.status, 0);
  expect_on_page(std::regex_replace(page.output, std::regex(R"(\\-)"), "-"), "");
}

TEST(ManPage, IsGoodRoff) {
  const TemporaryDirectory directory;
  const std::string page = quoted(directory.path() / "marti.1");
  ASSERT_EQ(marti("man > " + page).status, 0);
  if (has("groff")) {
    EXPECT_EQ(shell("groff -man -ww -z -Tascii " + page).output, "");
  }
  if (has("mandoc")) {
    // A page made from the program has no date of its own.
    EXPECT_EQ(shell("mandoc -Tlint -Wwarning " + page + " | grep -v 'missing date'").output, "");
  }
}

}  // namespace
}  // namespace marti::test
