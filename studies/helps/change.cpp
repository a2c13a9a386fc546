#include "studies/helps/change.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sim/error.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/setting_value.h"

namespace marti::studies::helps {

std::optional<Change> Changer::with(const std::vector<NewValue>& values) const {
  std::vector<KeyChange> keys;
  std::vector<sim::Setting> settings;
  for (const NewValue& value : values) {
    const std::size_t index = index_of(value.key);
    const sim::Key& key = config_.schema().keys()[index];
    if (!sim::in_range(key, value.to)) {
      return std::nullopt;
    }
    const sim::Value& from = value.from ? *value.from : now(value.key);
    if (now(value.key) != value.to || from != value.to) {
      keys.push_back({key.name, sim::print_value(key.type, from), sim::print_value(key.type, value.to)});
    }
    settings.push_back({index, {value.to}, 0, key.name});
  }
  return made(std::move(keys), std::move(settings));
}

std::size_t Changer::index_of(std::string_view key) const {
  const std::optional<std::size_t> index = config_.schema().find(key);
  sim::ensure(index.has_value(), "a key that is to change is not declared");
  return *index;
}

std::optional<Change> Changer::both(const Change& a, const Change& b) const {
  std::vector<KeyChange> keys = a.keys;
  keys.insert(keys.end(), b.keys.begin(), b.keys.end());
  std::vector<sim::Setting> settings = a.settings;
  for (const sim::Setting& setting : b.settings) {
    if (std::ranges::any_of(a.settings,
                            [&](const sim::Setting& other) { return other.key == setting.key; })) {
      return std::nullopt;
    }
    settings.push_back(setting);
  }
  return made(std::move(keys), std::move(settings));
}

std::optional<Change> Changer::made(std::vector<KeyChange> keys, std::vector<sim::Setting> settings) const {
  if (std::ranges::all_of(keys, [](const KeyChange& key) { return key.from == key.to; })) {
    return std::nullopt;
  }
  sim::Config config = config_.with(settings);
  try {
    return Change{std::move(keys), std::move(settings), keys::read_machine(config)};
  } catch (const sim::UserError&) {
    return std::nullopt;
  }
}

std::string describe(const std::vector<KeyChange>& keys) {
  std::string text;
  for (const KeyChange& key : keys) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", key.key, keys::plain_setting(key.from));
    if (key.from != key.to) {
      text += fmt::format(" -> {}", keys::plain_setting(key.to));
    }
  }
  return text;
}

}  // namespace marti::studies::helps
