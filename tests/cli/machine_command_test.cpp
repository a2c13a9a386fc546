// `marti run` of other machines: what each scheme, memory and structure reports, and that none changes the
// image.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/printed_json.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

TEST(MachineCommand, ThePipelineTakesTheStepsOfTheImageSchemeAndSaysHowBusyItsStagesAre) {
  const nlohmann::json moving = printed_json("run " + shipped("pipeline.toml") + small_teapot);
  const nlohmann::json whole = printed_json("run " + small_run);
  EXPECT_EQ(moving["figures"]["frame"], whole["figures"]["frame"]);
  const nlohmann::json& machine = moving["machine"];
  EXPECT_EQ(machine["scheme"], "pipeline");
  // Its base takes the same steps but writes no pixels and waits for no packets.
  EXPECT_LT(machine["one_node_time_ps"], whole["machine"]["one_node_time_ps"]);
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
  const auto machine_with = [&](const std::string& stages) {
    return printed_json("run " + shipped("pipeline.toml") + small_teapot + stages);
  };
  const nlohmann::json few =
      machine_with(" --set pipeline.search=12 --set pipeline.nearest=3 --set pipeline.shade=1");
  const nlohmann::json& helps = few["machine"]["what_helps"];
  EXPECT_EQ(helps["resources"][0]["resource"], "pipeline.nearest");
  EXPECT_EQ(helps["resources"][0]["step"]["keys"]["pipeline.nearest"]["to"], 4);
  EXPECT_TRUE(
      helps["sentence"].get<std::string>().starts_with("machine.nodes 16 -> 17, pipeline.nearest 3 -> 4"))
      << helps["sentence"];
  const nlohmann::json more =
      machine_with(" --set pipeline.search=8 --set pipeline.nearest=6 --set pipeline.shade=2");
  const auto end = [](const nlohmann::json& run) { return run["figures"]["machine"]["end"].get<double>(); };
  EXPECT_GT(end(few), 1.5 * end(more));
}

// Steps with units, with several keys and with key values that follow from others.
TEST(MachineCommand, AMeasuredStepIsReachedByItsArguments) {
  for (const char* name : {"marti.toml", "distributed.toml", "pipeline.toml"}) {
    const std::string run = "run " + shipped(name) + small_teapot;
    const nlohmann::json before = printed_json(run + " --what-helps");
    for (const nlohmann::json& resource : before["machine"]["what_helps"]["resources"]) {
      const nlohmann::json& step = resource["step"];
      if (step.is_null() || step["outcome"] != "measured") {
        continue;
      }
      std::string arguments;
      for (const nlohmann::json& argument : step["set"]) {
        arguments += " --set '" + argument.get<std::string>() + "'";
      }
      const nlohmann::json after = printed_json(run + " --no-what-helps" + arguments);
      EXPECT_EQ(after["figures"]["machine"]["end"], step["frame_time_ps"]) << arguments;
    }
  }
}

// Clocks of 1990 beside nodes of today are easily overlooked. 33 MHz is the default of all.
TEST(MachineCommand, ClocksLeftAtTheirDefaultBesideFasterOnesAreTold) {
  const std::string run =
      "run - --no-what-helps" + small_teapot + " --set interconnect.clock=40MHz < /dev/null";
  EXPECT_TRUE(printed_json(run + " --set node.clock=132MHz")["machine"]["notes"].empty())
      << "four times as fast";
  EXPECT_EQ(printed_json(run + " --set node.clock=133MHz")["machine"]["notes"],
            nlohmann::json({"memory.clock is 33 MHz, the default, beside node.clock of 133 MHz",
                            "host.clock is 33 MHz, the default, beside node.clock of 133 MHz"}));
  EXPECT_EQ(printed_json(run + " --set node.clock=133MHz --set l2.sharing=shared")["machine"]["notes"].size(),
            2)
      << "its clock is the interconnect's";
  EXPECT_TRUE(says(marti(run + " --set node.clock=133MHz"),
                   "\n  note        memory.clock is 33 MHz, the default, beside node.clock of 133 MHz\n"));
}

// Energy is worked out for every scheme, adds up, and changes nothing else.
TEST(MachineCommand, EnergyAddsUpAndChangesNoOtherFigure) {
  for (const char* config : {"marti.toml", "pipeline.toml", "space.toml", "distributed.toml"}) {
    const std::string arguments = "run --no-what-helps " + shipped(config) + small_teapot;
    const nlohmann::json without = printed_json(arguments)["figures"]["machine"];
    nlohmann::json with = printed_json(arguments + " --set energy.preset=22nm")["figures"]["machine"];
    std::int64_t sum = 0;
    for (const char* part : {"operations", "unit", "l1", "l2", "interconnect", "memory", "leakage"}) {
      sum += with["energy_" + std::string(part)].get<std::int64_t>();
      with.erase("energy_" + std::string(part));
    }
    const auto total = with["energy_total"].get<std::int64_t>();
    EXPECT_EQ(sum, total) << config;
    EXPECT_GT(total, 0);
    const auto end = with["end"].get<double>();
    EXPECT_DOUBLE_EQ(with["energy"].get<double>(), static_cast<double>(total) * 1e-12);
    EXPECT_DOUBLE_EQ(with["power"].get<double>(), static_cast<double>(total) * 1e-15 / (end * 1e-12));
    EXPECT_DOUBLE_EQ(with["energy_delay"].get<double>(), static_cast<double>(total) * 1e-9 * end * 1e-12);
    for (const char* figure :
         {"energy_total", "energy_area", "energy_cache_area", "energy_unit_area", "energy", "power",
          "rays_a_joule", "rays_a_second_mm2", "energy_a_ray", "energy_delay", "area"}) {
      EXPECT_EQ(with.erase(figure), 1U) << figure;
    }
    EXPECT_EQ(with, without) << config;
  }
  const std::string arguments = "run --no-what-helps " + small_run;
  const Outcome summary = marti(arguments + " --set energy.preset=22nm");
  EXPECT_TRUE(says(summary, "\nenergy        "));
  EXPECT_FALSE(says(marti(arguments), "\nenergy        "));
}

}  // namespace
}  // namespace marti::test
