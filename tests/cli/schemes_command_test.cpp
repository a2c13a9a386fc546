// `marti study schemes` as its user meets it: exit status, messages, files.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const std::string small_schemes = shipped("schemes.toml") +
                                  " --set scene.source=tetra:3 --set image.width=24 --set image.height=16"
                                  " --set 'schemes.nodes=[1,4,9]' --set 'schemes.cell_levels=[2,4,6]'"
                                  " --set schemes.stage_nodes=6";

TEST(SchemesCommand, WritesTablesAndChartsAndTheSameBytesAgain) {
  const TemporaryDirectory directory;
  expect_study("schemes " + small_schemes, directory.path(),
               {"Speed-up over one node", "pipeline", "space", "Statements beside what was measured"},
               {"schemes.csv", "stages.csv", "cells.csv", "claims.csv", "schemes.vl.json",
                "schemes_efficiency.vl.json", "stages.vl.json", "cells.vl.json", "results.sqlite"});
}

TEST(SchemesCommand, StructuresAreShownSideBySide) {
  const TemporaryDirectory directory;
  const std::string only = " --set 'schemes.nodes=[4]' --set 'schemes.cell_levels=[]'";
  const Outcome outcome =
      marti("study schemes " + small_schemes + only + " -o " + quoted(directory.path() / "a") +
            " --set 'schemes.structures=[\"octree\", \"grid\", \"bvh:2\", \"bvh:8_quantised\"]'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome, "the same frame and machine with each"));
  const std::string table = read(directory.path() / "a" / "structures.csv");
  EXPECT_EQ(table.find("structure,tree_nodes,tree_entries,database_bytes,visits,tests,references,misses,"),
            0U);
  EXPECT_NE(table.find("\nbvh:8_quantised,"), std::string::npos);
  // All machines on a bvh.
  const Outcome bvh = marti("study schemes " + small_schemes + only + " --set structure.kind=bvh -o " +
                            quoted(directory.path() / "b"));
  EXPECT_EQ(bvh.status, 0) << bvh.output;
}

TEST(SchemesCommand, WrongInputIsTwoAndSaysWhere) {
  const TemporaryDirectory directory;
  const std::string out = " -o " + quoted(directory.path() / "out");
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    expect_refused("study schemes " + small_schemes + out + options, complaint);
  };
  refused(" --set 'schemes.machines=[\"nowhere.toml\"]'", "nowhere.toml");
  refused(" --set 'schemes.machines=[]'", "schemes.machines");
  refused(" --set 'schemes.machines=[\"paper.toml\"]'", "paper.toml");
  refused(" --set 'schemes.nodes=[]'", "schemes.nodes");
  refused(" --set 'schemes.nodes=[0]'", "schemes.nodes");
  refused(" --set structure.kind=grid", "structure.kind");
  refused(" --set 'schemes.structures=[\"kd\"]'", "schemes.structures");
  refused(" --set schemes.stage_machine=marti.toml", "schemes.stage_machine");
  refused(" --set schemes.stage_nodes=2", "schemes.stage_nodes");
  refused(" --set machine.nodes=4", "machine.nodes=4: this command does not read it");
  refused(" --set frames.count=2", "frames.count");
}

}  // namespace
}  // namespace marti::test
