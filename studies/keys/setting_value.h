// The value of a setting in the forms that the program has: as text in a TOML file and in a store, typed in a
// result.json, and as people write it.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config.h"
#include "studies/tables/run_json.h"

namespace marti::studies::keys {

/// The typed value of TOML text: a size in bytes, a frequency in Hz, a duration in ps, a percentage as a
/// fraction, a boolean, a number, a text, or a list of these. The text without quotation marks where there is
/// no such key or the key has no such value: somebody may have changed the file.
[[nodiscard]] nlohmann::ordered_json setting_value(std::string_view key, const std::string& toml);

/// The TOML text of a typed value; `setting_value` gives the value back.
[[nodiscard]] std::string setting_toml(std::string_view key, const nlohmann::ordered_json& value);

/// TOML text as people write it: "16 KiB" without the quotation marks, other texts as they are. An empty text
/// stays "\"\"".
[[nodiscard]] std::string plain_setting(const std::string& toml);

/// "512 x 512 pixels", with the region that is rendered if it is not all of them, or "rays of FILE"; empty
/// where `settings`, TOML text by key, do not say it.
[[nodiscard]] std::string pixels_of(const std::map<std::string, std::string>& settings);

/// `config` of a result.json.
[[nodiscard]] nlohmann::ordered_json config_json(const std::string& file,
                                                 const std::vector<sim::EffectiveValue>& values);

/// The settings in `config` of a result.json, as TOML text by key. Throws UserError, naming the file and the
/// key, when one has no value.
[[nodiscard]] std::map<std::string, std::string> settings_of(const tables::RunJson& run);

}  // namespace marti::studies::keys
