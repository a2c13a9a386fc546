#include "studies/sweep/plan/table_texts.h"

#include <algorithm>
#include <utility>

#include "sim/config_errors.h"
#include "sim/nearest.h"

namespace marti::studies::sweep {

namespace {

constexpr std::size_t longest_line = 200;

}  // namespace

TableTexts::TableTexts(const sim::Config& config, const sim::DocumentValue::Table& table, int line,
                       std::string place, const std::vector<std::string>& keys,
                       std::span<const std::string_view> others)
    : config_(config), table_(table), line_(std::max(1, line)), place_(std::move(place)) {
  for (const sim::DocumentEntry& entry : table) {
    if (std::ranges::find(keys, entry.name) == keys.end() &&
        std::ranges::find(others, entry.name) == others.end()) {
      fail(entry.name, "unknown key" + sim::did_you_mean(entry.name, keys));
    }
  }
}

void TableTexts::fail(const std::string& message) const { sim::fail_at(config_, line_, place_, message); }

void TableTexts::fail(std::string_view key, const std::string& message) const {
  const sim::DocumentEntry* const entry = sim::find(table_, key);
  sim::fail_at(config_, entry == nullptr ? line_ : entry->line, place_ + "." + std::string(key), message);
}

const sim::DocumentEntry& TableTexts::entry(std::string_view key) const {
  const sim::DocumentEntry* const entry = sim::find(table_, key);
  if (entry == nullptr) {
    fail(key, "is missing");
  }
  return *entry;
}

const std::string& TableTexts::text(std::string_view key) const {
  const sim::DocumentEntry& given = entry(key);
  if (given.value.text() == nullptr || given.value.text()->empty()) {
    fail(key, "must be a text, not " + describe(given.value));
  }
  return *given.value.text();
}

std::string TableTexts::text_or_none(std::string_view key) const {
  return sim::find(table_, key) == nullptr ? std::string() : text(key);
}

const std::string& TableTexts::line(std::string_view key) const {
  const std::string& given = text(key);
  const bool plain =
      std::ranges::none_of(given, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
  if (given.size() > longest_line || !plain) {
    fail(key, "must be a line of 1 to " + std::to_string(longest_line) + " characters");
  }
  return given;
}

sim::Place TableTexts::place(std::string_view key) const {
  return sim::place_in_file(config_.name(), entry(key).line, place_ + "." + std::string(key));
}

}  // namespace marti::studies::sweep
