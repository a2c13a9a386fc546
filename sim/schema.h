// The keys that a configuration may have. Each key is declared once, with type, default, range, unit and
// meaning; reading (sim/config.h), `marti config` and the reference in docs/ all use these declarations. Each
// folder declares its own keys in a function `void declare_<what>_keys(sim::Schema&)`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <variant>
#include <vector>

#include "sim/time.h"

namespace marti::sim {

enum class ValueType { boolean, integer, real, text, choice, size, frequency, duration, percentage };

/// "integer", "size", ...
std::string_view name_of(ValueType type);

/// One value. boolean: bool; integer, size (bytes), duration (ticks): int64; real, frequency (hertz),
/// percentage (fraction): double; text, choice: string.
using Value = std::variant<bool, std::int64_t, double, std::string>;

/// The value as a real, in the units of Value; std::nullopt for booleans and texts.
[[nodiscard]] inline std::optional<double> number_of(const Value& value) {
  if (const auto* const whole = std::get_if<std::int64_t>(&value)) {
    return static_cast<double>(*whole);
  }
  const auto* const real = std::get_if<double>(&value);
  return real != nullptr ? std::optional(*real) : std::nullopt;
}

/// The value as written in a TOML file: `"16 KiB"`, `3`, `0.5`, `true`.
std::string print_value(ValueType type, const Value& value);

/// A name that a choice had before, or has elsewhere. It is refused with a message that says today's, so that
/// no file means something by it that its reader cannot look up.
struct RenamedChoice {
  std::string_view before;
  std::string_view now;
};

struct Key {
  std::string name;  // dotted: "cache.size"
  ValueType type = ValueType::text;
  bool is_list = false;
  /// Of a text: a list or a table may be given too, and is kept as what print_in_line() makes of it
  /// (sim/document.h); its reader tells it from a text by the bracket or brace that it begins with.
  bool may_be_composite = false;
  std::vector<Value> default_value;  // exactly one unless is_list
  std::optional<Value> minimum;      // inclusive; never for boolean, text, choice
  std::optional<Value> maximum;
  std::vector<std::string> choices;        // of a choice, in the order of their indices
  std::span<const RenamedChoice> renamed;  // of a choice; must outlive the schema
  std::string unit;                        // for an integer or a real: "cycles"; empty if it has none
  std::string meaning;                     // one or two sentences, without the full stop
};

/// Whether the key has this name or lies in the section of this name or below it; always if it is empty.
[[nodiscard]] inline bool is_or_is_below(const Key& key, std::string_view name) {
  return name.empty() ||
         (key.name.starts_with(name) && (key.name.size() == name.size() || key.name[name.size()] == '.'));
}

/// The values of `key` as written in a TOML file, a list in brackets.
std::string print_values(const Key& key, std::span<const Value> values);
/// "16 KiB to 1 GiB", "lru, fifo or random", "at least 1"; empty when every value of the type is allowed.
std::string print_range(const Key& key);

/// Whether a value of the key's type lies in its range or is one of its choices.
bool in_range(const Key& key, const Value& value);

/// A headed group of keys: "cache" holds "cache.size". Names may be dotted themselves.
struct Section {
  std::string name;  // the keys' prefix without the final dot
  std::string meaning;
};

struct NameHash {
  using is_transparent = void;
  std::size_t operator()(std::string_view name) const { return std::hash<std::string_view>()(name); }
};

class Schema {
 public:
  template <class T>
  struct Range {
    std::optional<T> minimum{};
    std::optional<T> maximum{};
  };

  /// Describes the keys with this prefix. Call it before declaring them.
  void section(std::string_view name, std::string_view meaning);
  /// As section(). In addition, everything that a file has below this name, a table of the first level, is
  /// kept unread, except for the keys declared there (Config::free_section).
  void free_section(std::string_view name, std::string_view meaning);

  /// Declares that only `command` reads this section; an error message about its keys says so. For sections
  /// in which this schema declares no key.
  void elsewhere(std::string_view section, std::string_view command);

  // A declaration throws InternalError when the name was declared before, is not made of lower-case
  // letters, digits, '_' and '.', or the default lies outside the range. Ranges and defaults of sizes,
  // frequencies, durations and percentages are written with their units.
  void boolean(std::string_view name, bool default_value, std::string_view meaning);
  void integer(std::string_view name, std::int64_t default_value, Range<std::int64_t> range,
               std::string_view unit, std::string_view meaning);
  void real(std::string_view name, double default_value, Range<double> range, std::string_view unit,
            std::string_view meaning);
  void text(std::string_view name, std::string_view default_value, std::string_view meaning);
  /// A text that may also be given as a list or a table (Key::may_be_composite).
  void text_or_composite(std::string_view name, std::string_view default_value, std::string_view meaning);
  void choice(std::string_view name, std::string_view default_value, std::vector<std::string> choices,
              std::string_view meaning, std::span<const RenamedChoice> renamed = {});
  void size(std::string_view name, std::string_view default_value, Range<std::string_view> range,
            std::string_view meaning);
  void frequency(std::string_view name, std::string_view default_value, Range<std::string_view> range,
                 std::string_view meaning);
  void duration(std::string_view name, std::string_view default_value, Range<std::string_view> range,
                std::string_view meaning);
  void percentage(std::string_view name, std::string_view default_value, Range<std::string_view> range,
                  std::string_view meaning);
  void integers(std::string_view name, std::vector<std::int64_t> default_value, Range<std::int64_t> range,
                std::string_view unit, std::string_view meaning);
  void reals(std::string_view name, std::vector<double> default_value, Range<double> range,
             std::string_view unit, std::string_view meaning);
  void texts(std::string_view name, std::vector<std::string> default_value, std::string_view meaning);
  /// Declares any key, for kinds that the functions above do not cover (lists of choices, of sizes, ...).
  void add(Key key);

  /// In the order of declaration.
  [[nodiscard]] std::span<const Key> keys() const { return keys_; }
  [[nodiscard]] std::span<const Section> sections() const { return sections_; }
  [[nodiscard]] std::span<const std::string> names() const { return names_; }
  /// Index into keys(), if the key is declared.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;
  [[nodiscard]] bool is_free_section(std::string_view name) const;
  /// The command that reads this key, if elsewhere() names one; else empty.
  [[nodiscard]] std::string_view elsewhere_of(std::string_view name) const;
  /// Whether `name` is a proper prefix of declared keys ("cache" of "cache.size"), or a free section.
  [[nodiscard]] bool is_section(std::string_view name) const;

 private:
  std::vector<Key> keys_;
  std::vector<std::string> names_;
  std::vector<Section> sections_;
  std::vector<std::string> free_sections_;
  std::vector<std::pair<std::string, std::string>> elsewhere_;  // section and command
  // Looked up for every key of every machine of a sweep, hence without a copy of the name.
  std::unordered_map<std::string, std::size_t, NameHash, std::equal_to<>> index_;
  std::unordered_set<std::string, NameHash, std::equal_to<>> prefixes_;
};

/// Every key with type, default, unit, range and meaning, for a terminal `width` columns wide. `only`: the
/// key of this name, or the keys of this section and those below it; empty: all.
std::string list_keys_as_text(const Schema& schema, int width = 100, std::string_view only = {});
/// As list_keys_as_text(), in Markdown with one table a section.
std::string list_keys_as_markdown(const Schema& schema);

}  // namespace marti::sim
