// Configurations that ask for two features which no machine has together: an assignment of another scheme
// switches off what the file asks for; else they are refused, whichever of the two came first.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>

#include "processors/machine/combinations.h"
#include "tests/support/configuration_of.h"
#include "tests/support/user_error.h"

namespace marti::studies {
namespace {

using processors::machine::Feature;
using processors::machine::RefusedPair;
using test::read_machine_of;

// What asks for each feature: a value of a key, and a key in the file that has no use without it.
struct Asked {
  std::string key;
  std::string value;
  std::string more;
};
const std::array<Asked, processors::machine::features> asked = {{
    {"node.contexts", "4", "node.switch_cycles = 2"},
    {"prefetch.children", "true", "prefetch.outstanding = 2"},
    {"build.sharing", "\"shared\"", "build.initial_level = \"2\""},
    {"database.placement", "\"distributed\"", "database.interleave = \"4 KiB\""},
    {"l2.sharing", "\"private\"", "l2.ways = 4"},
    {"count.sharing", "true", ""},
    {"node.kind", "\"simt\"", "simt.warps = 2"},
    {"machine.scheme", "\"pipeline\"", "pipeline.queue = 2"},
}};
const Asked& asked_of(Feature feature) { return asked[static_cast<std::size_t>(feature)]; }

std::string line_of(const Asked& one) { return one.key + " = " + one.value + "\n"; }

std::string assignment(const Asked& one) { return one.key + "=" + one.value; }

TEST(CombinationKeys, AFileThatAsksForBothIsRefusedAtTheLineOfTheFirst) {
  for (const RefusedPair& pair : processors::machine::refused_pairs()) {
    const Asked& first = asked_of(pair.first);
    const Asked& second = asked_of(pair.second);
    const std::string message = test::user_error_of(
        [&] { (void)read_machine_of("machine.nodes = 16\n" + line_of(second) + line_of(first)); });
    EXPECT_TRUE(message.starts_with("machine.toml:3: " + first.key + ": " + first.value +
                                    " does not combine with " + second.key + " = " + second.value))
        << message;
    const std::string assigned = test::user_error_of([&] {
      (void)read_machine_of("", {assignment(first), assignment(second)});
    });
    EXPECT_NE(assigned.find("does not combine"), std::string::npos) << assigned;
  }
}

TEST(CombinationKeys, OnlyAnotherSchemeSwitchesOffWhatTheFileAsksFor) {
  for (const RefusedPair& pair : processors::machine::refused_pairs()) {
    for (const auto& [on, off] : {std::pair(pair.first, pair.second), std::pair(pair.second, pair.first)}) {
      SCOPED_TRACE(asked_of(on).key + ", " + asked_of(off).key);
      const std::string file = "machine.nodes = 16\n" + line_of(asked_of(off)) + asked_of(off).more + "\n";
      EXPECT_TRUE(processors::machine::has(read_machine_of(file), off));
      if (on != Feature::moving_rays) {
        const std::string message =
            test::user_error_of([&] { (void)read_machine_of(file, {assignment(asked_of(on))}); });
        EXPECT_NE(message.find("does not combine"), std::string::npos) << message;
        continue;
      }
      const processors::machine::MachineConfig machine = read_machine_of(file, {assignment(asked_of(on))});
      EXPECT_TRUE(processors::machine::has(machine, on));
      EXPECT_FALSE(processors::machine::has(machine, off));
    }
  }
}

}  // namespace
}  // namespace marti::studies
