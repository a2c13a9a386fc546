// A file that describes a sweep, given to the commands that run one machine.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <tuple>
#include <utility>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const std::string small_image = " --set image.width=16 --set image.height=16";

TEST(SweepConfig, RunAndTraceTakeTheFilesOwnMachine) {
  const TemporaryDirectory directory;
  const std::string machine = "[scene]\nsource = \"teapot:2\"\n[machine]\nnodes = 3\n";
  const fs::path plain = directory.path() / "plain.toml";
  const fs::path sweep = directory.path() / "sweep.toml";
  write(plain, machine);
  write(sweep, machine +
                   "[sweep]\nfilter = \"cache.ways < 3\"\n[sweep.axes]\nmachine.nodes = [1, 2]\n"
                   "anything = \"goes\"\n");
  const Outcome expected = marti("run " + quoted(plain) + small_image);
  const Outcome found = marti("run " + quoted(sweep) + small_image);
  EXPECT_EQ(found.status, 0) << found.output;
  EXPECT_EQ(found.output, expected.output);
  const Outcome priced = marti("run " + quoted(sweep) + small_image + " --set prices.node=3");
  EXPECT_EQ(priced.status, 0) << priced.output;
  // Prices change the advice, which is the first line and the last lines.
  const auto between = [](const std::string& output) {
    const std::size_t scene = output.find("\nscene ");
    return output.substr(scene, output.find("what helps") - scene);
  };
  const std::size_t advice = priced.output.find("what helps");
  EXPECT_EQ(between(priced.output), between(expected.output));
  EXPECT_NE(priced.output.find(", without a price", advice), std::string::npos) << priced.output;
  const Outcome trace =
      marti("trace " + quoted(sweep) + small_image + " -o " + quoted(directory.path() / "trace"));
  EXPECT_EQ(trace.status, 0) << trace.output;
}

TEST(SweepConfig, MisspeltSectionsStayErrors) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "a.toml";
  for (const auto& [text, message] : std::initializer_list<std::pair<const char*, const char*>>{
           {"[swep.axes]\nmachine.nodes = [1]\n", ":2: swep.axes.machine.nodes: unknown key"},
           {"[price]\nnode = 1\n", ":2: price.node: unknown key"},
           {"sweep = 3\n", ":1: sweep: is a section and has no value of its own"},
           {"[sweep]\na = 1979-05-27\n", ":2: sweep.a: must not be a date or time"},
       }) {
    write(file, text);
    expect_refused("run " + quoted(file), message);
  }
}

// The shipped questions about the paper's arguments, of a smaller image and fewer machines: directions only.
TEST(SweepConfig, ThePapersArgumentsAboutParallelMachinesAgree) {
  const std::string small = " --quiet --set image.width=96 --set image.height=96 -o ";
  for (const auto& [file, axis, claims] : std::initializer_list<std::tuple<const char*, const char*, int>>{
           {"parallel-schemes", " --axis machine.nodes=1,4,16,64", 3},
           {"pipeline-stages", "", 1},
           {"cell-size", " --axis structure.max_level=5,7,11", 1}}) {
    const TemporaryDirectory directory;
    const Outcome found = marti("sweep " + shipped("questions/" + std::string(file) + ".toml") + axis +
                                small + quoted(directory.path() / "out"));
    ASSERT_EQ(found.status, 0) << found.output;
    int agree = 0;
    for (std::size_t at = 0; (at = found.output.find("\n  agrees  ", at)) != std::string::npos; ++at) {
      ++agree;
    }
    EXPECT_EQ(agree, claims) << found.output;
  }
}

}  // namespace
}  // namespace marti::test
