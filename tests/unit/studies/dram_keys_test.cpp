// The keys of a memory of DRAM: what they make, and what can be made better in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "memory/dram_presets.h"
#include "studies/helps/resources.h"
#include "studies/keys/machine_keys.h"
#include "tests/support/configuration_of.h"

namespace marti::studies {

using namespace helps;
using namespace keys;

namespace {

using memory::DramConfig;

processors::machine::MachineConfig dram_machine_of(std::vector<std::string> assignments) {
  assignments.emplace_back("memory.model=dram");
  sim::Config config = test::configuration_of(assignments);
  return read_machine(config);
}

TEST(DramKeys, WithoutOthersTheyMakeThePreset) {
  sim::Config fixed = test::configuration_of({});
  EXPECT_FALSE(read_machine(fixed).banks.dram.has_value());
  EXPECT_FALSE(dram_machine_of({"interconnect.kind=ideal"}).banks.dram.has_value());
  for (std::size_t i = 0; i < memory::dram_preset_names.size(); ++i) {
    const DramConfig expected = memory::dram_preset(i);
    const processors::machine::MachineConfig machine =
        dram_machine_of({"dram.preset=" + std::string(memory::dram_preset_names[i])});
    ASSERT_TRUE(machine.banks.dram.has_value());
    const DramConfig& dram = *machine.banks.dram;
    EXPECT_EQ(dram.period, expected.period);
    EXPECT_EQ(dram.timing.bl, expected.timing.bl);
    EXPECT_EQ(dram.timing.rcd, expected.timing.rcd);
    EXPECT_EQ(dram.timing.faw, expected.timing.faw);
    EXPECT_EQ(dram.timing.rfc, expected.timing.rfc);
    EXPECT_EQ(dram.row_bytes, expected.row_bytes);
    EXPECT_EQ(dram.banks_of_rank(), expected.banks_of_rank());
    EXPECT_EQ(dram.pseudo_channels, expected.pseudo_channels);
    EXPECT_EQ(machine.banks.banks(), expected.channels);
  }
}

TEST(DramKeys, EachReplacesOneFigureOfThePreset) {
  const processors::machine::MachineConfig machine = dram_machine_of(
      {"dram.policy=frfcfs", "dram.page=closed", "dram.queue=8", "dram.reorder_cap=3", "dram.tck=1000",
       "dram.channels=4", "dram.ranks=2", "dram.row=4KiB", "dram.burst=32B", "dram.trcd=20", "dram.trefi=0",
       "dram.mapping=[\"column:2\", \"channel\", \"column\", \"bank\", \"bank_group\", \"rank\", \"row\"]"});
  const DramConfig& dram = *machine.banks.dram;
  EXPECT_EQ(dram.policy, memory::DramPolicy::frfcfs);
  EXPECT_EQ(dram.page, memory::DramPage::closed);
  EXPECT_EQ(dram.queue, 8U);
  EXPECT_EQ(dram.reorder_cap, 3U);
  EXPECT_EQ(dram.period, 1000);
  EXPECT_EQ(machine.banks.banks(), 4U);
  EXPECT_EQ(dram.ranks, 2U);
  EXPECT_EQ(dram.row_bytes, 4096U);
  EXPECT_EQ(dram.burst_bytes, 32U);
  EXPECT_EQ(dram.timing.rcd, 20);
  EXPECT_EQ(dram.timing.rp, 16);
  EXPECT_EQ(dram.timing.refi, 0);
  ASSERT_EQ(dram.mapping.size(), 7U);
  EXPECT_EQ(dram.mapping[0].bits, 2U);
  EXPECT_EQ(dram.mapping[3].field, memory::DramField::bank);
}

TEST(DramKeys, EveryResourceThatIsTriedChangesTheMemory) {
  const std::vector<std::string> assignments = {"memory.model=dram"};
  sim::Config config = test::configuration_of(assignments);
  const processors::machine::MachineConfig machine = read_machine(config);
  FrameFacts facts;
  facts.packets = 100;
  std::vector<std::string> names;
  const std::vector<Resource> resources = resources_of(Changer(config), machine, facts);
  for (const Resource& resource : resources) {
    if (resource.part != Part::banks) {
      continue;
    }
    names.push_back(resource.name);
    ASSERT_TRUE(resource.step.has_value()) << resource.name;
    const DramConfig& changed = *resource.step->machine.banks.dram;
    const DramConfig& now = *machine.banks.dram;
    const bool same = changed.period == now.period && changed.channels == now.channels &&
                      changed.timing.cl == now.timing.cl && changed.timing.rcd == now.timing.rcd &&
                      changed.timing.rp == now.timing.rp && changed.page == now.page &&
                      changed.policy == now.policy;
    EXPECT_FALSE(same) << resource.name;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"dram.tck", "dram.channels", "dram.tcl", "dram.trcd", "dram.trp",
                                             "dram.page", "dram.policy"}));
}

}  // namespace
}  // namespace marti::studies
