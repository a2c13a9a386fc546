#include "processors/machine/combinations.h"

#include "sim/key_error.h"

namespace marti::processors::machine {

namespace {

constexpr std::array refused = {
    RefusedPair{Feature::contexts, Feature::moving_rays,
                "a context is a packet of pixels, and where rays move nodes take rays, not packets"},
    RefusedPair{Feature::prefetch, Feature::moving_rays,
                "where rays move, a node has one read under way at a time, that of the ray it works on, and "
                "a prefetch "
                "would be another"},
    RefusedPair{
        Feature::building, Feature::moving_rays,
        "the tree must be given: each node has one kind of work or one region of space, and splitting "
        "branches is part of neither"},
    RefusedPair{
        Feature::building, Feature::distributed,
        "a read may overtake another node's write in the network, so nodes cannot share a tree that is "
        "built in a distributed memory; use \"private\" or \"none\"",
        "build.sharing = \"shared\"",
        [](const MachineConfig& config) { return config.build.sharing == Sharing::shared; }},
    RefusedPair{Feature::contexts, Feature::simt,
                "the warps of a SIMT node take the place of contexts; set simt.warps"},
    RefusedPair{Feature::prefetch, Feature::simt,
                "these prefetchers look at one step at a time, and a SIMT node takes many at once; "
                "its own are prefetch.stack and prefetch.treelet"},
    RefusedPair{Feature::building, Feature::simt,
                "a ray-tracing unit reads a tree and cannot split its branches; build it before the frame"},
    RefusedPair{Feature::distributed, Feature::simt,
                "the memory of a node serves one access after the other, and the unit has many under way; "
                "use \"shared\" or \"replicated\""},
    RefusedPair{Feature::simt, Feature::moving_rays,
                "a warp takes packets of pixels, and where rays move nodes take rays one by one"},
    RefusedPair{Feature::distributed, Feature::moving_rays,
                "in a pipeline the network carries rays, and nodes read a memory that they share; with "
                "\"space\" each node has its part of the database already"},
};

struct Setting {
  std::string_view key;
  std::string value;
};

// The key by which a machine asks for a feature that it has.
Setting setting_of(const MachineConfig& config, Feature feature) {
  const auto named = [](const auto& names, auto value) {
    return '"' + std::string(names[static_cast<std::size_t>(value)]) + '"';
  };
  using enum Feature;
  switch (feature) {
    case contexts:
      return {"node.contexts", std::to_string(config.contexts)};
    case prefetch:
      return {config.prefetch.next_line ? "prefetch.next_line" : "prefetch.children", "true"};
    case building:
      return {"build.sharing", named(sharing_names, config.build.sharing)};
    case distributed:
      return {"database.placement", named(placement_names, config.placement)};
    case private_second_level:
      return {"l2.sharing", named(second_level_names, config.l2.sharing)};
    case counting:
      return {key_of(config.count), "true"};
    case simt:
      return {"node.kind", named(node_kind_names, config.kind)};
    case moving_rays:
      break;
  }
  return {"machine.scheme", named(scheme_names, config.scheme)};
}

}  // namespace

std::span<const RefusedPair> refused_pairs() { return refused; }

bool is_refused(const MachineConfig& config, const RefusedPair& pair) {
  return has(config, pair.first) && has(config, pair.second) &&
         (pair.only_if == nullptr || pair.only_if(config));
}

bool has(const MachineConfig& config, Feature feature) {
  using enum Feature;
  switch (feature) {
    case contexts:
      return config.contexts > 1;
    case prefetch:
      return config.prefetch.on();
    case building:
      return config.build.sharing != Sharing::given;
    case distributed:
      return config.placement == Placement::distributed;
    case private_second_level:
      return config.l2.sharing == SecondLevel::private_caches;
    case counting:
      return config.count.any();
    case simt:
      return config.kind == NodeKind::simt;
    case moving_rays:
      return config.scheme != Scheme::image;
  }
  return false;
}

std::string_view key_of(const MachineConfig& config, Feature feature) {
  return setting_of(config, feature).key;
}

void check_combinations(const MachineConfig& config) {
  for (const RefusedPair& pair : refused) {
    if (is_refused(config, pair)) {
      const Setting first = setting_of(config, pair.first);
      const Setting second = setting_of(config, pair.second);
      throw sim::KeyError(std::string(first.key), first.value + " does not combine with " +
                                                      std::string(second.key) + " = " + second.value + ": " +
                                                      std::string(pair.reason));
    }
  }
}

}  // namespace marti::processors::machine
