#include "sim/config.h"

#include <algorithm>

#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/key_value.h"
#include "sim/shown.h"

namespace marti::sim {

namespace {

/// Whether `key` is `name` itself or a key in the section `name`.
bool covers(std::string_view name, std::string_view key) {
  return key == name || (key.starts_with(name) && key[name.size()] == '.');
}

template <class T>
std::vector<T> unpack(std::span<const Value> values) {
  std::vector<T> unpacked;
  unpacked.reserve(values.size());
  for (const Value& value : values) {
    unpacked.push_back(std::get<T>(value));
  }
  return unpacked;
}

}  // namespace

Config::Config(std::shared_ptr<const Schema> schema, std::string name)
    : schema_(std::move(schema)), name_(std::move(name)), entries_(schema_->keys().size()) {}

std::size_t Config::index_of(std::string_view key) const {
  const std::optional<std::size_t> index = schema_->find(key);
  if (!index) {
    throw InternalError("the key " + std::string(key) + " is not declared");
  }
  return *index;
}

std::span<const Value> Config::values_at(std::size_t key) const {
  const Entry& entry = entries_[key];
  return entry.given == nullptr ? std::span<const Value>(schema_->keys()[key].default_value)
                                : std::span<const Value>(entry.given->values);
}

std::span<const Value> Config::read(std::string_view key, ValueType type, bool is_list) const {
  const std::size_t index = index_of(key);
  if (schema_->keys()[index].type != type || schema_->keys()[index].is_list != is_list) {
    throw InternalError("the key " + std::string(key) + " is read as another type than it is declared");
  }
  entries_[index].used = true;
  return values_at(index);
}

bool Config::boolean(std::string_view key) const {
  return std::get<bool>(read(key, ValueType::boolean, false).front());
}

std::int64_t Config::integer(std::string_view key) const {
  return std::get<std::int64_t>(read(key, ValueType::integer, false).front());
}

double Config::real(std::string_view key) const {
  return std::get<double>(read(key, ValueType::real, false).front());
}

const std::string& Config::text(std::string_view key) const {
  return std::get<std::string>(read(key, ValueType::text, false).front());
}

std::size_t Config::choice(std::string_view key) const {
  const std::vector<std::string>& choices = schema_->keys()[index_of(key)].choices;
  const auto found = std::find(choices.begin(), choices.end(), choice_name(key));
  return static_cast<std::size_t>(found - choices.begin());
}

const std::string& Config::choice_name(std::string_view key) const {
  return std::get<std::string>(read(key, ValueType::choice, false).front());
}

std::int64_t Config::size(std::string_view key) const {
  return std::get<std::int64_t>(read(key, ValueType::size, false).front());
}

double Config::frequency(std::string_view key) const {
  return std::get<double>(read(key, ValueType::frequency, false).front());
}

Ticks Config::duration(std::string_view key) const {
  return std::get<std::int64_t>(read(key, ValueType::duration, false).front());
}

double Config::percentage(std::string_view key) const {
  return std::get<double>(read(key, ValueType::percentage, false).front());
}

std::vector<std::int64_t> Config::integers(std::string_view key) const {
  return unpack<std::int64_t>(read(key, ValueType::integer, true));
}

std::vector<double> Config::reals(std::string_view key) const {
  return unpack<double>(read(key, ValueType::real, true));
}

std::vector<std::string> Config::texts(std::string_view key) const {
  return unpack<std::string>(read(key, ValueType::text, true));
}

std::span<const Value> Config::values(std::string_view key) const {
  const std::size_t index = index_of(key);
  entries_[index].used = true;
  return values_at(index);
}

bool Config::given(std::string_view key) const { return given_at(index_of(key)); }

bool Config::assigned(std::string_view key) const {
  const Entry& entry = entries_[index_of(key)];
  return entry.given != nullptr && entry.line() == 0;
}

std::string Config::where(std::string_view key) const { return where(entries_[index_of(key)]); }

std::string Config::where(const Entry& entry) const {
  if (entry.given == nullptr) {
    return "default";
  }
  return entry.line() > 0 ? name_ + ":" + std::to_string(entry.line()) : entry.given->place;
}

Place Config::place(std::string_view key) const {
  const Entry& entry = entries_[index_of(key)];
  if (assigned(key) && entry.given->place.starts_with("--set ")) {  // names the key itself
    return {shown(entry.given->place), {}, 0, std::string(key)};
  }
  // Of a default it is the file in which it could be changed.
  return place_in_file(name_, entry.line(), key);
}

void Config::fail(std::string_view key, std::string_view message) const {
  Place at = place(key);
  const bool elsewhere = assigned(key) && !at.file.empty();
  throw UserError(std::move(at),
                  shown(message, all_shown) + (elsewhere ? " (in " + shown(where(key)) + ")" : ""));
}

void Config::mark_unused_reason(std::string_view key_or_section, std::string_view reason,
                                std::string_view decided_by) {
  ensure(schema_->find(key_or_section).has_value() || schema_->is_section(key_or_section),
         "a reason is given for a key that is not declared");
  const bool by_assignment = !decided_by.empty() && assigned(decided_by);
  unused_reasons_.push_back({std::string(key_or_section), std::string(reason), by_assignment});
}

const Config::UnusedReason* Config::unused_reason(std::string_view key) const {
  const UnusedReason* best = nullptr;
  for (const UnusedReason& reason : unused_reasons_) {
    if (covers(reason.covers, key) && (best == nullptr || reason.covers.size() >= best->covers.size())) {
      best = &reason;
    }
  }
  return best;
}

void Config::refuse_unused() const {
  const Entry* first = nullptr;
  std::string_view key;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    // The unused key on the lowest line; one of an assignment, with line 0, only if the file has none.
    const bool earlier =
        first == nullptr || (entry.line() > 0 && (first->line() == 0 || entry.line() < first->line()));
    if (entry.given == nullptr || entry.used || !earlier) {
      continue;
    }
    const UnusedReason* reason = unused_reason(schema_->names()[i]);
    if (entry.line() > 0 && reason != nullptr && reason->by_assignment) {
      continue;
    }
    first = &entry;
    key = schema_->names()[i];
  }
  if (first == nullptr) {
    return;
  }
  const UnusedReason* reason = unused_reason(key);
  fail(key, reason == nullptr ? "is not used by this configuration; leave it out"
                              : "is not used: " + reason->reason);
}

std::vector<EffectiveValue> Config::effective_values() const {
  std::vector<EffectiveValue> effective;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (entry.used) {
      const Key& key = schema_->keys()[i];
      effective.push_back({key.name, print_values(key, values_at(i)), entry.given != nullptr, where(entry)});
    }
  }
  return effective;
}

const DocumentValue::Table& Config::free_section(std::string_view name) const {
  static const DocumentValue::Table nothing;
  ensure(schema_->is_free_section(name), "a free section is read that is not declared");
  for (const FreeSection& section : free_sections_) {
    if (section.name == name) {
      return *section.table->table();
    }
  }
  return nothing;
}

int Config::free_section_line(std::string_view name) const {
  for (const FreeSection& section : free_sections_) {
    if (section.name == name) {
      return section.table->line;
    }
  }
  return 0;
}

std::vector<Value> Config::parse(std::size_t key, const DocumentValue& value, std::string_view label) const {
  const Key& declared = schema_->keys()[key];
  return read_values(declared, value,
                     place_in_file(name_, value.line, label.empty() ? declared.name : label));
}

void Config::set(Setting setting) {
  entries_[setting.key].given =
      std::make_shared<const Given>(Given{std::move(setting.values), setting.line, std::move(setting.place)});
}

void Config::reset(std::size_t key) { entries_[key].given = nullptr; }

Config Config::with(std::span<const Setting> settings) const {
  Config variant = *this;
  for (Entry& entry : variant.entries_) {
    entry.used = false;
  }
  variant.unused_reasons_.clear();
  for (const Setting& setting : settings) {
    variant.set(setting);
  }
  return variant;
}

std::string_view Config::why_unused(std::string_view key) const {
  const UnusedReason* reason = unused_reason(key);
  return reason == nullptr ? std::string_view() : std::string_view(reason->reason);
}

}  // namespace marti::sim
