// The keys of [energy]: what a preset gives, what a key replaces, and what has no use on a machine.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "processors/energy/energy_presets.h"
#include "tests/support/configuration_of.h"
#include "tests/support/user_error.h"

namespace marti::studies {
namespace {

using test::read_machine_of;

TEST(EnergyKeys, AreOffByDefault) {
  const processors::machine::MachineConfig machine = read_machine_of("");
  EXPECT_FALSE(machine.energy.on());
}

TEST(EnergyKeys, ReplaceThePresetsFiguresOneByOne) {
  const std::string preset = "[energy]\npreset = \"22nm\"\n";
  const processors::machine::EnergyFigures usual =
      processors::energy::energy_figures(processors::machine::EnergyPreset::nm22);
  const processors::machine::EnergyFigures kept = read_machine_of(preset + "divide = -1.0\n").energy.figures;
  EXPECT_EQ(kept.divide, usual.divide);
  EXPECT_EQ(kept.l1.read, processors::machine::by_shape);
  const processors::machine::EnergyFigures changed =
      read_machine_of(preset + "divide = 0.0\nl1_area = 2.5\nleakage_density = 7\n").energy.figures;
  EXPECT_EQ(changed.divide, 0.0);
  EXPECT_EQ(changed.l1.area, 2.5);
  EXPECT_EQ(changed.leakage_density, 7.0);
  EXPECT_EQ(changed.square_root, usual.square_root);
  EXPECT_EQ(changed.l1.read, processors::machine::by_shape);
  EXPECT_EQ(read_machine_of(preset + "voltage = 0.5\n").energy.voltage, 0.5);
}

// Each key is read where the machine has the part, and refused where it has not.
TEST(EnergyKeys, AreRefusedWithoutThePartThatTheyAreOf) {
  struct Part {
    std::string key;
    std::string without;
    std::string with;
  };
  const std::vector<Part> parts = {
      {"l1_read", "cache.organisation = \"none\"", "cache.organisation = \"split\""},
      {"l2_write", "l2.sharing = \"none\"", "l2.sharing = \"private\""},
      {"context_area", "node.contexts = 1", "node.contexts = 2"},
      {"hop_length", "machine.scheme = \"image\"", "machine.scheme = \"pipeline\""},
      {"interconnect_length", "machine.scheme = \"space\"", "machine.scheme = \"pipeline\""},
  };
  for (const Part& part : parts) {
    const std::string energy = "\n[energy]\npreset = \"45nm\"\n" + part.key + " = 0.5\n";
    const std::string refusal = test::user_error_of([&] { (void)read_machine_of(part.without + energy); });
    EXPECT_TRUE(refusal.starts_with("machine.toml:4: energy." + part.key + ": is not used")) << refusal;
    EXPECT_EQ(test::user_error_of([&] { (void)read_machine_of(part.with + energy); }), "no UserError");
  }
  // An option may switch off what the file describes.
  EXPECT_FALSE(
      read_machine_of("[energy]\npreset = \"45nm\"\nadd = 0.5\n", {"energy.preset=none"}).energy.on());
}

}  // namespace
}  // namespace marti::studies
