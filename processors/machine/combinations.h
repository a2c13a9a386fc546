// Which features of a simulated machine combine. A machine has none of them unless it asks for them; most may
// be had together, and the pairs that may not are listed here, nowhere else.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "processors/machine/machine_config.h"

namespace marti::processors::machine {

enum class Feature : std::uint8_t {
  contexts,
  prefetch,
  building,
  distributed,
  private_second_level,
  counting,
  simt,
  moving_rays,
};
inline constexpr std::size_t features = 8;

struct FeatureText {
  std::string_view name;     ///< as the documents call it
  std::string_view setting;  ///< the keys that ask for it
};
/// In the order of Feature.
inline constexpr std::array<FeatureText, features> feature_texts = {{
    {"several contexts", "node.contexts above 1"},
    {"prefetching", "prefetch.next_line, prefetch.children"},
    {"building the tree", "build.sharing other than \"given\""},
    {"distributed memory", "database.placement = \"distributed\""},
    {"private second level", "l2.sharing = \"private\""},
    {"detailed counting", "count.miss_classes, count.sharing, count.attribution"},
    {"SIMT nodes", "node.kind = \"simt\""},
    {"rays that move", "machine.scheme = \"pipeline\" or \"space\""},
}};

/// Two features that no machine has together.
struct RefusedPair {
  Feature first;
  Feature second;
  std::string_view reason;
  /// Of the first feature only this setting is refused, of which only_if() tells; empty and null: any.
  std::string_view setting{};
  bool (*only_if)(const MachineConfig& config) = nullptr;
};
[[nodiscard]] std::span<const RefusedPair> refused_pairs();

/// Whether `config` has both features as the pair refuses them.
[[nodiscard]] bool is_refused(const MachineConfig& config, const RefusedPair& pair);

/// Whether `config` asks for the feature.
[[nodiscard]] bool has(const MachineConfig& config, Feature feature);

/// The key by which `config` asks for a feature that it has.
[[nodiscard]] std::string_view key_of(const MachineConfig& config, Feature feature);

/// Throws KeyError, which names the keys of both, when `config` has two features that do not combine.
void check_combinations(const MachineConfig& config);

}  // namespace marti::processors::machine
