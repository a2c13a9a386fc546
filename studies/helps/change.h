// A machine that differs from another in the values of a few configuration keys.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "processors/machine/machine_config.h"
#include "sim/config.h"

namespace marti::studies::helps {

/// A key and its values before and after, as one would write them in a TOML file. Both are equal for a key
/// that was not given: its value followed from other keys, and must now be given so that it does not change
/// with them.
struct KeyChange {
  std::string key;
  std::string from;
  std::string to;
};

/// A value that a key is to get. `from` is its value now, where that follows from other keys.
struct NewValue {
  std::string_view key;
  sim::Value to;
  std::optional<sim::Value> from{};
};

struct Change {
  std::vector<KeyChange> keys;         ///< all that must be given to get the machine
  std::vector<sim::Setting> settings;  ///< of all keys that must be set
  processors::machine::MachineConfig machine;
};

/// Makes changes of the machine that a configuration describes.
class Changer {
 public:
  /// `config` must outlive the object.
  explicit Changer(const sim::Config& config) : config_(config) {}

  /// The machine with these values. std::nullopt if nothing differs, or if a value is not allowed or the
  /// machine cannot be built.
  [[nodiscard]] std::optional<Change> with(const std::vector<NewValue>& values) const;
  /// Both changes at once; std::nullopt also if they set the same key.
  [[nodiscard]] std::optional<Change> both(const Change& a, const Change& b) const;

  /// Index into the schema's keys.
  [[nodiscard]] std::size_t index_of(std::string_view key) const;
  [[nodiscard]] const sim::Key& key(std::string_view name) const {
    return config_.schema().keys()[index_of(name)];
  }
  /// Whether the configuration gives the key a value.
  [[nodiscard]] bool given(std::string_view key) const { return config_.given_at(index_of(key)); }
  /// The key's value in the configuration.
  [[nodiscard]] const sim::Value& now(std::string_view key) const {
    return config_.values_at(index_of(key)).front();
  }

 private:
  [[nodiscard]] std::optional<Change> made(std::vector<KeyChange> keys,
                                           std::vector<sim::Setting> settings) const;

  const sim::Config& config_;
};

/// "machine.nodes 64 -> 71", several keys with commas between them; "pipeline.search 5" for one that stays as
/// it is.
[[nodiscard]] std::string describe(const std::vector<KeyChange>& keys);

}  // namespace marti::studies::helps
