// The settings of many machines that differ in few of them.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "sim/config.h"

namespace marti::studies::sweep {

/// The settings of one section of a configuration, in the order of the schema; immutable, and shared by all
/// machines that have them alike.
using SettingsPart = std::shared_ptr<const std::vector<sim::EffectiveValue>>;

/// A machine's settings, section by section.
using SharedSettings = std::vector<SettingsPart>;

/// The section of a key: what is before its last dot.
[[nodiscard]] std::string_view section_of(std::string_view key);

/// Makes parts; equal parts are stored once. The settings of a section must stand together.
class SettingsPool {
 public:
  [[nodiscard]] SharedSettings share(std::vector<sim::EffectiveValue> settings);

 private:
  std::unordered_map<std::string, SettingsPart> parts_;
};

/// All settings of a machine, in the order of the schema.
[[nodiscard]] std::vector<sim::EffectiveValue> all_of(const SharedSettings& settings);

}  // namespace marti::studies::sweep
