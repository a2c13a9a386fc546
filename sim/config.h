// A configuration: the values given in a TOML file and by `--set key=value`, checked against a Schema.
//
// Any fault of the input is a UserError whose message begins with "file:line: key: " or with "--set
// key=value: " and says what would be right. Faults are: a missing, huge or malformed file, an unknown key
// (with the nearest valid name), a wrong type, a value out of range, a key that is given but not used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/document.h"
#include "sim/error.h"
#include "sim/schema.h"
#include "sim/time.h"

namespace marti::sim {

/// The most bytes of a configuration file.
inline constexpr std::int64_t longest_config = 1 << 20;

/// The value that a key had in a run, and where it came from.
struct EffectiveValue {
  std::string key;
  std::string value;   // as one would write it in a TOML file
  bool given = false;  // false: the default
  std::string source;  // "file:line", "--set key=value" or "default"
};

/// A value given to a key of a Config that was read before.
struct Setting {
  std::size_t key = 0;  // index into the schema's keys
  std::vector<Value> values;
  int line = 0;       // in the file that it comes from; 0: it comes from no file
  std::string place;  // if line is 0: replaces "--set key=value" in messages
};

/// Cheap to copy: copies share the schema and the values given.
class Config {
 public:
  /// Reads a file of at most longest_config bytes. Each assignment is the "key=value" of a --set option;
  /// assignments override the file, and later ones earlier ones. A value is read as TOML, or as an unquoted
  /// text if it is not TOML (`cache.size=32KiB`) or if the key is a text or a choice.
  static Config from_file(const Schema& schema, const std::filesystem::path& file,
                          std::span<const std::string> assignments = {});
  /// from_file() for a given text; `name` replaces the file's name in messages.
  static Config from_text(const Schema& schema, std::string_view text, std::string_view name,
                          std::span<const std::string> assignments = {});

  // The value of a key, or its default if it is not given. Each call marks the key as used, so two threads
  // must not read a Config at once. Asking for an undeclared key, or for another type than the declared one,
  // is an InternalError. References live as long as the Config.
  [[nodiscard]] bool boolean(std::string_view key) const;
  [[nodiscard]] std::int64_t integer(std::string_view key) const;
  [[nodiscard]] double real(std::string_view key) const;
  [[nodiscard]] const std::string& text(std::string_view key) const;
  /// Index into the declared choices.
  [[nodiscard]] std::size_t choice(std::string_view key) const;
  [[nodiscard]] const std::string& choice_name(std::string_view key) const;
  /// The choice as an enumeration whose values are the indices of the declared choices.
  template <class Enum>
  [[nodiscard]] Enum choice_as(std::string_view key) const {
    return static_cast<Enum>(choice(key));
  }
  [[nodiscard]] std::int64_t size(std::string_view key) const;  // bytes
  [[nodiscard]] double frequency(std::string_view key) const;   // hertz
  [[nodiscard]] Ticks duration(std::string_view key) const;     // ticks
  [[nodiscard]] double percentage(std::string_view key) const;  // fraction
  [[nodiscard]] std::vector<std::int64_t> integers(std::string_view key) const;
  [[nodiscard]] std::vector<double> reals(std::string_view key) const;
  [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
  /// The values of any key, lists included.
  [[nodiscard]] std::span<const Value> values(std::string_view key) const;

  /// Whether the key is given, in the file or by --set. Does not mark it as used.
  [[nodiscard]] bool given(std::string_view key) const;
  /// Whether the key is given by --set or another assignment, not by the file. Does not mark it as used.
  [[nodiscard]] bool assigned(std::string_view key) const;
  /// "file:line", "--set key=value" or "default".
  [[nodiscard]] std::string where(std::string_view key) const;
  /// "file:line: key" or "--set key=value"; of a key that is not given, "file: key".
  [[nodiscard]] Place place(std::string_view key) const;
  /// Throws the UserError "place: message".
  [[noreturn]] void fail(std::string_view key, std::string_view message) const;

  /// Sets the reason why the key, or all keys of the section, are not used in this machine ("has no effect
  /// with interconnect.kind = \"ideal\""). The longest matching name wins. `decided_by` is the key whose
  /// value is the reason: if an assignment set it, unused keys in the file are not errors, so that an
  /// assignment can switch off what the file describes.
  void mark_unused_reason(std::string_view key_or_section, std::string_view reason,
                          std::string_view decided_by = {});
  /// Throws a UserError when a key is given that was not read. Call it when the machine is assembled.
  void refuse_unused() const;

  /// The values of all keys read so far, in the order of the schema.
  [[nodiscard]] std::vector<EffectiveValue> effective_values() const;

  /// The content of a free section in the file, without its declared keys; an empty table if it is not given.
  /// Lives as long as the Config and its copies.
  [[nodiscard]] const DocumentValue::Table& free_section(std::string_view name) const;
  /// The line of the section's name; 0 if it is not given.
  [[nodiscard]] int free_section_line(std::string_view name) const;

  /// The values that `value` gives the key of this index. Throws the UserError "file:line: key: message" for
  /// another type and for a value out of range; a non-empty `label` replaces the key in the message.
  [[nodiscard]] std::vector<Value> parse(std::size_t key, const DocumentValue& value,
                                         std::string_view label = {}) const;
  /// Gives the key these values, which come from parse() or are declared by the schema.
  void set(Setting setting);
  /// Resets the key to its default.
  void reset(std::size_t key);
  /// A copy with these settings, in which no key is marked as used.
  [[nodiscard]] Config with(std::span<const Setting> settings) const;

  // By index into the schema's keys. None of these marks the key as used.
  [[nodiscard]] std::span<const Value> values_at(std::size_t key) const;
  [[nodiscard]] bool given_at(std::size_t key) const { return entries_[key].given != nullptr; }
  [[nodiscard]] bool used_at(std::size_t key) const { return entries_[key].used; }
  /// Marks the key as used, because it was read from a copy.
  void use(std::size_t key) { entries_[key].used = true; }
  /// The reason set by mark_unused_reason for the key; empty if there is none.
  [[nodiscard]] std::string_view why_unused(std::string_view key) const;
  /// Takes over the reasons set in a copy.
  void take_reasons(const Config& copy) { unused_reasons_ = copy.unused_reasons_; }

  [[nodiscard]] const Schema& schema() const { return *schema_; }
  /// The file's name as it appears in messages.
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  struct Given {
    std::vector<Value> values;
    int line = 0;       // in the file; 0: set by an assignment
    std::string place;  // if line is 0: "--set key=value"
  };
  struct Entry {
    std::shared_ptr<const Given> given;  // null: the default holds
    mutable bool used = false;
    [[nodiscard]] int line() const { return given == nullptr ? 0 : given->line; }
  };
  struct FreeSection {
    std::string name;
    std::shared_ptr<const DocumentValue> table;
  };

  Config(std::shared_ptr<const Schema> schema, std::string name);
  std::span<const Value> read(std::string_view key, ValueType type, bool is_list) const;
  [[nodiscard]] std::size_t index_of(std::string_view key) const;
  [[nodiscard]] std::string where(const Entry& entry) const;

  friend class ConfigReader;

  std::shared_ptr<const Schema> schema_;
  std::string name_;
  std::vector<FreeSection> free_sections_;
  std::vector<Entry> entries_;  // one for each key of the schema, in its order
  struct UnusedReason {
    std::string covers;  // key or section
    std::string reason;
    bool by_assignment = false;
  };
  [[nodiscard]] const UnusedReason* unused_reason(std::string_view key) const;

  std::vector<UnusedReason> unused_reasons_;
};

}  // namespace marti::sim
