#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "processors/machine/combinations.h"
#include "sim/config_errors.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

namespace {

using processors::machine::Feature;
using processors::machine::MachineConfig;
using processors::machine::RefusedPair;

// The keys of which a value other than the default asks for the feature.
std::vector<std::string_view> keys_of(Feature feature) {
  using enum Feature;
  switch (feature) {
    case contexts:
      return {"node.contexts"};
    case prefetch:
      return {"prefetch.next_line", "prefetch.children"};
    case building:
      return {"build.sharing"};
    case distributed:
      return {"database.placement"};
    case private_second_level:
      return {"l2.sharing"};
    case counting:
      return {"count.miss_classes", "count.sharing", "count.attribution"};
    case simt:
      return {"node.kind"};
    case moving_rays:
      break;
  }
  return {"machine.scheme"};
}

// A machine with the features that the keys ask for, and nothing else. It reads a copy, so that no key counts
// as used.
MachineConfig features_of(const sim::Config& given) {
  const sim::Config config = given;  // NOLINT(performance-unnecessary-copy-initialization)
  MachineConfig machine;
  machine.contexts = count(config, "node.contexts");
  machine.prefetch.next_line = config.boolean("prefetch.next_line");
  machine.prefetch.children = config.boolean("prefetch.children");
  machine.build.sharing = config.choice_as<processors::machine::Sharing>("build.sharing");
  machine.placement = config.choice_as<processors::machine::Placement>("database.placement");
  machine.l2.sharing = config.choice_as<processors::machine::SecondLevel>("l2.sharing");
  machine.count = {config.boolean("count.miss_classes"), config.boolean("count.sharing"),
                   config.boolean("count.attribution")};
  machine.kind = config.choice_as<processors::machine::NodeKind>("node.kind");
  machine.scheme = config.choice_as<processors::machine::Scheme>("machine.scheme");
  return machine;
}

bool is_assigned(const sim::Config& config, Feature feature) {
  const std::vector<std::string_view> keys = keys_of(feature);
  return std::ranges::any_of(keys, [&](std::string_view key) { return config.assigned(key); });
}

// Sets the keys of `off` as if the assignment of `place` had.
void switch_off(sim::Config& config, Feature off, const std::string& place) {
  for (const std::string_view key : keys_of(off)) {
    const std::size_t number = *config.schema().find(key);
    config.set({number, config.schema().keys()[number].default_value, 0, place});
  }
}

}  // namespace

void settle_combinations(sim::Config& config) {
  for (const RefusedPair& pair : processors::machine::refused_pairs()) {
    const bool another_scheme = pair.second == Feature::moving_rays && is_assigned(config, pair.second);
    if (another_scheme && !is_assigned(config, pair.first) &&
        processors::machine::is_refused(features_of(config), pair)) {
      switch_off(config, pair.first, config.where("machine.scheme"));
    }
  }
  const MachineConfig machine = features_of(config);
  sim::with_places(config, [&] { processors::machine::check_combinations(machine); });
}

}  // namespace marti::studies::keys
