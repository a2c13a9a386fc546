// Beginners' mistakes: each gets one line that names the remedy, and exit status 2.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

struct Mistake {
  const char* name;
  std::string arguments;
  std::vector<std::string> answer;  // parts of the message
};

std::ostream& operator<<(std::ostream& out, const Mistake& mistake) { return out << mistake.name; }

class FirstHour : public testing::TestWithParam<Mistake> {};

TEST_P(FirstHour, TheAnswerNamesTheRemedy) {
  const TemporaryDirectory directory;
  fs::create_directory(directory.path() / "configs");
  fs::create_directory(directory.path() / "deep");
  for (const char* name : {"marti.toml", "paper.toml", "sweep-small.toml", "error.toml"}) {
    fs::copy(fs::path(MARTI_SOURCE) / "configs" / name, directory.path() / "configs");
  }
  write(directory.path() / "afile", "x");
  write(directory.path() / "word.toml", "[cache]\nreplacement = lru\n");
  write(directory.path() / "size.toml", "[cache]\n\nsize = 16 KiB  # large\n");
  write(directory.path() / "number.toml", "[node]\nclock = 100\n");
  write(directory.path() / "empty.toml", "[cache]\nsize =\n");
  write(directory.path() / "unit.toml", "[cache]\nsize = \"16 KB\"\n");
  write(directory.path() / "scene.toml", "[scene]\nsource = \"mine.glb\"\n");
  write(directory.path() / "lost.obj", "v 0 0 0\nf 1 1 9\n");
  const Outcome outcome =
      shell("cd " + quoted(directory.path()) + " && " + quoted(MARTI_PROGRAM) + " " + GetParam().arguments);
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << outcome.output;
  EXPECT_TRUE(outcome.output.starts_with("marti: ")) << outcome.output;
  for (const std::string& part : GetParam().answer) {
    EXPECT_PRED_FORMAT2(testing::IsSubstring, part, outcome.output);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, FirstHour,
    testing::Values(
        Mistake{"HelpOnNoCommand", "help rnu", {"no command \"rnu\"", "did you mean \"run\""}},
        Mistake{"WrongKeyOfConfig", "config machine.node", {"no key", "did you mean \"machine.nodes\""}},
        Mistake{"WrongAxis",
                "sweep configs/marti.toml --axis machine.node=1,2",
                {"did you mean \"machine.nodes\""}},
        Mistake{"WrongCommand", "rnu configs/marti.toml", {"no command \"rnu\"", "did you mean \"run\""}},
        Mistake{"NoRun", "configs/marti.toml", {"marti run configs/marti.toml"}},
        Mistake{"NoConfiguration", "run", {"run: CONFIG is missing", "configs/marti.toml"}},
        Mistake{"WrongDirectory",
                "run config/marti.toml",
                {"config/marti.toml: there is no such file", "did you mean \"configs/marti.toml\"",
                 "the current directory is /"}},
        Mistake{"WrongFile", "run configs/martin.toml", {"did you mean \"configs/marti.toml\""}},
        Mistake{"NoDirectory", "run marti.toml", {"did you mean \"configs/marti.toml\""}},
        Mistake{"ADirectory", "run configs", {"is a directory", "such as configs/error.toml"}},
        Mistake{"WrongOption", "run configs/marti.toml --ouput out", {"did you mean \"--output\""}},
        Mistake{"KeyWithoutSet", "run configs/marti.toml machine.nodes=4", {"--set machine.nodes=4"}},
        Mistake{
            "KeyWithoutEquals", "run configs/marti.toml --set machine.nodes 4", {"unexpected \"4\"", "="}},
        Mistake{"ValueWithoutQuotes",
                "run configs/marti.toml --set cache.size=16 KiB",
                {"unexpected \"KiB\"", "quotation marks", "--set 'cache.size=16 KiB'"}},
        Mistake{
            "WrongKey", "run configs/marti.toml --set machine.node=4", {"did you mean \"machine.nodes\""}},
        Mistake{
            "KeyWithoutSection", "run configs/marti.toml --set nodes=4", {"did you mean \"machine.nodes\""}},
        Mistake{"TextWithoutQuotes", "run word.toml", {"word.toml:2", "replacement = \"lru\""}},
        Mistake{"SizeWithoutQuotes", "run size.toml", {"size.toml:3", "size = \"16 KiB\""}},
        Mistake{"NoValue", "run empty.toml", {"empty.toml:2", "the value is missing"}},
        Mistake{"NoUnit", "run number.toml", {"number.toml:2: node.clock", "such as \"33 MHz\""}},
        Mistake{"WrongUnit", "run unit.toml", {"unit.toml:2: cache.size", "write KiB"}},
        Mistake{"ToleranceWithoutUnit", "run configs/marti.toml --within 2", {"such as \"2 %\""}},
        Mistake{"OutputIsAFile", "run configs/marti.toml -o afile", {"afile: is a file", "directory"}},
        Mistake{"NoScene", "run scene.toml", {"scene.toml:2: scene.source", "mine.glb", "beside it"}},
        Mistake{"NoPosition", "scene info lost.obj", {"lost.obj:2: a corner refers to position 9"}},
        Mistake{
            "WrongScene", "run configs/marti.toml --set scene.source=teapott", {"did you mean \"teapot\""}},
        Mistake{"RunOfAStudy", "run configs/paper.toml", {"paper.toml:", "for `marti study paper`"}},
        Mistake{"StudyOfASweep", "study error configs/sweep-small.toml -o out", {"for `marti sweep`"}},
        Mistake{"SweepOfAMachine", "sweep configs/marti.toml -o out", {"[sweep.axes]"}},
        Mistake{"SweepWithoutOutput", "sweep configs/sweep-small.toml", {"-o DIR is missing"}},
        Mistake{"WrongStudy", "study papers configs/paper.toml", {"did you mean \"paper\"", "stability"}},
        Mistake{"NoStudy", "study", {"study: which command?", "paper"}},
        Mistake{
            "SceneWithoutVerb", "scene teapot:12", {"no command \"teapot:12\"", "list, info and export"}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(FirstHourFromBelow, AConfigurationInADirectoryAboveIsFound) {
  const TemporaryDirectory directory;
  fs::create_directories(directory.path() / "configs");
  fs::create_directories(directory.path() / "build" / "release");
  write(directory.path() / "configs" / "mine.toml", "");
  const Outcome outcome = shell("cd " + quoted(directory.path() / "build" / "release") + " && " +
                                quoted(MARTI_PROGRAM) + " run configs/mine.toml");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "did you mean \"../../configs/mine.toml\"", outcome.output);
}

}  // namespace
}  // namespace marti::test
