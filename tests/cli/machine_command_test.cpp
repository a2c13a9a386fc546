// `marti run` of other machines: what each scheme, memory and structure reports, and that none changes the
// image.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/shell.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

TEST(MachineCommand, ThePipelineTakesTheStepsOfTheImageSchemeAndSaysHowBusyItsStagesAre) {
  const fs::path config = fs::path(MARTI_SOURCE) / "configs" / "pipeline.toml";
  const auto result_of = [&](const fs::path& file) {
    const Outcome outcome = marti("run --json " + quoted(file) + small_teapot);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output);
  };
  const nlohmann::json moving = result_of(config);
  const nlohmann::json whole = result_of(fs::path(MARTI_SOURCE) / "configs" / "marti.toml");
  EXPECT_EQ(moving["figures"]["frame"], whole["figures"]["frame"]);
  const nlohmann::json& machine = moving["machine"];
  EXPECT_EQ(machine["scheme"], "pipeline");
  EXPECT_EQ(machine["one_node_time_ps"], whole["machine"]["one_node_time_ps"]);
  const nlohmann::json& figures = moving["figures"]["machine"];
  for (const auto& [name, count] : figures.items()) {
    if (name.starts_with("steps_")) {
      EXPECT_EQ(count, name == "steps_pixels" ? nlohmann::json(0) : whole["figures"]["machine"][name])
          << name;
    }
  }
  const nlohmann::json& flow = machine["flow"];
  EXPECT_EQ(flow["stages"].size(), 3U);
  EXPECT_EQ(flow["per_node"].size(), 16U);
  EXPECT_EQ(figures["flow_rays"], figures["flow_ended"]);
  EXPECT_EQ(figures["flow_collected"], figures["flow_contributions"]);
  EXPECT_EQ(figures["network_messages"].get<std::int64_t>(),
            24 * 16 + figures["flow_passed_on"].get<std::int64_t>() +
                figures["flow_collected"].get<std::int64_t>());
}

TEST(MachineCommand, MoreNodesOfItsSlowestStageHelpAPipeline) {
  const fs::path config = fs::path(MARTI_SOURCE) / "configs" / "pipeline.toml";
  const auto machine_with = [&](const std::string& stages) {
    const Outcome outcome = marti("run --json " + quoted(config) + small_teapot + stages);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output);
  };
  const nlohmann::json few =
      machine_with(" --set pipeline.search=12 --set pipeline.nearest=3 --set pipeline.shade=1");
  const nlohmann::json& helps = few["machine"]["what_helps"];
  EXPECT_EQ(helps["resources"][0]["resource"], "pipeline.nearest");
  EXPECT_EQ(helps["resources"][0]["step"]["keys"]["pipeline.nearest"]["to"], "4");
  EXPECT_TRUE(
      helps["sentence"].get<std::string>().starts_with("machine.nodes 16 -> 17, pipeline.nearest 3 -> 4"))
      << helps["sentence"];
  const nlohmann::json more =
      machine_with(" --set pipeline.search=8 --set pipeline.nearest=6 --set pipeline.shade=2");
  const auto end = [](const nlohmann::json& run) { return run["figures"]["machine"]["end"].get<double>(); };
  EXPECT_GT(end(few), 1.5 * end(more));
}

TEST(MachineCommand, ADistributedDatabaseReportsItsMessagesAndMemories) {
  const fs::path config = fs::path(MARTI_SOURCE) / "configs" / "distributed.toml";
  for (const char* kind : {"mesh", "ideal"}) {
    const std::string options = small_teapot + std::string(" --set network.kind=") + kind;
    const Outcome outcome = marti("run --json " + quoted(config) + options);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const nlohmann::json result = nlohmann::json::parse(outcome.output);
    const nlohmann::json& machine = result["machine"];
    const nlohmann::json& figures = result["figures"]["machine"];
    const nlohmann::json& cluster = machine["per_cluster"][0];
    const nlohmann::json& distributed = cluster["distributed"];
    const auto count = [&](const char* name) { return distributed[name].get<std::int64_t>(); };
    EXPECT_EQ(cluster["banks"].size(), 16U);
    EXPECT_EQ(cluster["interconnect"]["reads"].get<std::int64_t>(),
              count("local_reads") + count("remote_reads"));
    EXPECT_EQ(count("local_writes") + count("remote_writes"), 24 * 16);
    EXPECT_EQ(distributed["network"]["messages"].get<std::int64_t>(),
              2 * count("remote_reads") + count("remote_writes"));
    EXPECT_EQ(figures.contains("interconnect_utilisation"), kind != std::string("ideal"));
    EXPECT_EQ(figures["database_copies"], 1);
    const Outcome summary = marti("run " + quoted(config) + options);
    EXPECT_NE(summary.output.find("spread over 16 nodes"), std::string::npos) << summary.output;
    EXPECT_NE(summary.output.find("\nmemories "), std::string::npos) << summary.output;
  }
}

}  // namespace
}  // namespace marti::test
