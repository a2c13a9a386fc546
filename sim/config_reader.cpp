// Reads a Config, through toml++, which no other file of the project includes.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

// toml++ 3.3 asserts that a name begins at a position before it checks that ("[#" is a header without a
// name); without assertions some compilers are told to assume it. The checks of toml++ that follow refuse
// such texts, so the assertions are switched off.
#undef NDEBUG
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#include "sim/config.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/input_files.h"
#include "sim/key_value.h"
#include "sim/nearest.h"
#include "sim/shown.h"
#include "sim/toml_place.h"
#include "sim/toml_text.h"
#include "sim/trim.h"

namespace marti::sim {

namespace {

// toml++ recurses into tables and bounds only the depth of values, so a key of 100,000 parts would overflow
// the stack.
constexpr std::size_t most_key_parts = 32;
constexpr std::string_view name_too_deep = "a name has more than 32 parts joined by dots";

struct Origin {
  Place place;
  std::string assignment;  // empty: of the file
};

constexpr std::size_t whole_line = std::numeric_limits<std::size_t>::max();  // a column behind all of it

[[noreturn]] void fail_at(const Origin& origin, const std::string& message) {
  throw UserError(origin.place, message);
}

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '"' || c == '\'';
}

/// The line of a dotted name with too many parts, which toml++ must not read; 0 when there is none.
std::size_t line_too_deep(std::string_view text) {
  std::size_t line = 1;
  std::size_t parts = 0;
  bool after_dot = true;  // another dot here would not separate two parts of a name
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      parts = 0;
    } else if (c == '.') {
      parts += after_dot ? 0 : 1;
      after_dot = true;
    } else if (is_key_character(c)) {
      after_dot = false;
    } else if (c != ' ' && c != '\t') {
      parts = 0;
      after_dot = true;
    }
    if (parts > most_key_parts) {
      return line;
    }
  }
  return 0;
}

DocumentValue document_of(const toml::node& node, int line);

/// The entries of a table in the order of the file; toml++ sorts them by name.
DocumentValue::Table entries_of(const toml::table& table) {
  struct Place {
    toml::source_position at;
    DocumentEntry entry;
  };
  std::vector<Place> places;
  places.reserve(table.size());
  for (const auto& [key, node] : table) {
    const toml::source_position at = key.source().begin;
    const int line = static_cast<int>(at.line);
    places.push_back({at, {std::string(key.str()), line, document_of(node, line)}});
  }
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.at < b.at; });
  DocumentValue::Table entries;
  entries.reserve(places.size());
  for (Place& place : places) {
    entries.push_back(std::move(place.entry));
  }
  return entries;
}

/// `line` is that of the surrounding node, for a node without a line of its own.
DocumentValue document_of(const toml::node& node, int line) {
  DocumentValue value;
  value.line = node.source().begin ? static_cast<int>(node.source().begin.line) : line;
  switch (node.type()) {
    case toml::node_type::table:
      value.content = entries_of(*node.as_table());
      break;
    case toml::node_type::array: {
      DocumentValue::List list;
      list.reserve(node.as_array()->size());
      for (const toml::node& element : *node.as_array()) {
        list.push_back(document_of(element, value.line));
      }
      value.content = std::move(list);
      break;
    }
    case toml::node_type::string:
      value.content = node.ref<std::string>();
      break;
    case toml::node_type::integer:
      value.content = node.ref<std::int64_t>();
      break;
    case toml::node_type::floating_point:
      value.content = node.ref<double>();
      break;
    case toml::node_type::boolean:
      value.content = node.ref<bool>();
      break;
    default:
      break;  // a date or time
  }
  return value;
}

/// Refuses values that a free section must not contain.
void check_free(const DocumentValue& value, const std::string& name, std::string_view file) {
  const auto fail = [&] {
    throw UserError(place_in_file(file, value.line, name), "must not be " + describe(value));
  };
  if (std::holds_alternative<std::monostate>(value.content)) {
    fail();
  } else if (const double* real = std::get_if<double>(&value.content)) {
    if (!std::isfinite(*real)) {
      fail();
    }
  } else if (const DocumentValue::List* list = value.list()) {
    for (const DocumentValue& element : *list) {
      check_free(element, name, file);
    }
  } else if (const DocumentValue::Table* table = value.table()) {
    for (const DocumentEntry& entry : *table) {
      check_free(entry.value, name + "." + entry.name, file);
    }
  }
}

/// A line of a text that could not be read, and the name of the key or table that the reader was at.
struct FaultyLine {
  std::string_view text;  // without its comment
  std::string name;       // "cache.size"; may be empty
};

/// `column` may be beyond the line's end.
FaultyLine line_of(std::string_view text, std::size_t line, std::size_t column) {
  const std::size_t begin = byte_of(text, line, 1);
  const std::string_view from = text.substr(begin);
  const std::string_view whole = from.substr(0, from.find('\n'));
  std::size_t end = std::min(byte_of(text, line, column), begin + whole.size());
  // A fault that is reported where a table's head begins is one of the table.
  if (end == begin && whole.starts_with('[')) {
    end += std::min(whole.find(']'), whole.size());
  }
  std::string name = name_at(text, end);
  // Of a byte that is no character toml++ knows the line only.
  name = name.empty() ? name_at(text, begin + whole.size()) : name;
  return {trim(whole.substr(0, whole.find('#')), " \t\r"), std::move(name)};
}

/// The correction to suggest where a text lacks its quotation marks, the commonest fault; empty for other
/// faults.
std::string missing_quotes(const FaultyLine& line) {
  const std::size_t equals = line.text.find('=');
  if (equals == std::string_view::npos || line.text.find_first_of("\"'[]{}") != std::string_view::npos) {
    return "";
  }
  const std::string_view value = trim(line.text.substr(equals + 1));
  if (value.empty()) {
    return "; the value is missing";
  }
  // The fault of a number, a boolean or a date is another one.
  const bool letters =
      std::any_of(value.begin(), value.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
  return !letters || value == "true" || value == "false"
             ? ""
             : "; texts and values with a unit stand in quotation marks: " +
                   shown(trim(line.text.substr(0, equals))) + " = \"" + shown(value) + "\"";
}

/// Whether the text is an integer of more than 18 characters, which probably exceeds 64 bits.
bool is_long_integer(std::string_view text) {
  text.remove_prefix(text.starts_with('-') || text.starts_with('+') ? 1 : 0);
  return text.size() > 18 && text.find_first_not_of("0123456789_") == std::string_view::npos;
}

}  // namespace

/// Builds one Config. Throws at the first fault, in the order of the text.
class ConfigReader {
 public:
  ConfigReader(std::shared_ptr<const Schema> schema, std::string name)
      : config_(std::move(schema), std::move(name)) {}

  Config read(std::string_view text, std::span<const std::string> assignments) {
    read_text(text);
    for (const std::string& assignment : assignments) {
      assign(assignment);
    }
    return std::move(config_);
  }

 private:
  struct Found {
    std::string key;
    const toml::node* node;
    int line;
  };

  void read_text(std::string_view text) {
    if (const std::size_t line = line_too_deep(text); line != 0) {
      throw UserError(place_of(line_of(text, line, whole_line), line), std::string(name_too_deep));
    }
    if (const std::size_t line = line_beyond_ascii(text); line != 0) {
      throw UserError(place_of(line_of(text, line, whole_line), line),
                      "a character that is not ASCII, outside of a text in quotes and of a comment");
    }
    try {
      const toml::table document = toml::parse(text, config_.name_);
      std::vector<Found> found;
      flatten(document, "", found);
      std::stable_sort(found.begin(), found.end(),
                       [](const Found& a, const Found& b) { return a.line < b.line; });
      for (const Found& one : found) {
        const Origin origin{place_in_file(config_.name_, one.line, one.key), {}};
        store(one.key, document_of(*one.node, one.line), origin);
      }
    } catch (const toml::parse_error& error) {
      const toml::source_position at = error.source().begin;
      const FaultyLine line = line_of(text, at.line, at.column);
      throw UserError(place_of(line, at.line, ":" + std::to_string(at.column)),
                      shown(error.description()) + missing_quotes(line));
    }
  }

  /// "file:number: name", with a column behind the number; without the name where none has begun.
  [[nodiscard]] Place place_of(const FaultyLine& line, std::size_t number,
                               const std::string& column = {}) const {
    return {shown(config_.name_) + ":" + std::to_string(number) + column +
                (line.name.empty() ? "" : ": " + shown(line.name)),
            config_.name_, static_cast<int>(number), line.name};
  }

  /// Lists the values below `table` under their dotted names. An empty table is listed itself.
  void flatten(const toml::table& table, const std::string& prefix, std::vector<Found>& found) {
    for (const auto& [key, node] : table) {
      // A part that contains dots would look like several parts; in quotation marks it is an unknown key.
      const bool plain = key.str().find('.') == std::string_view::npos && !key.str().empty();
      const std::string part = plain ? std::string(key.str()) : "\"" + std::string(key.str()) + "\"";
      const std::string name = prefix.empty() ? part : prefix + "." + part;
      const toml::table* inner = node.as_table();
      if (inner != nullptr && prefix.empty() && config_.schema_->is_free_section(name)) {
        keep_free(*inner, name, static_cast<int>(key.source().begin.line), found);
        continue;
      }
      // An empty section with a known name has no effect and is allowed.
      if (inner != nullptr && !config_.schema_->find(name)) {
        if (!inner->empty()) {
          flatten(*inner, name, found);
          continue;
        }
        if (config_.schema_->is_section(name)) {
          continue;
        }
      }
      found.push_back({name, &node, static_cast<int>(key.source().begin.line)});
    }
  }

  /// Keeps the content of a free section unread, except for declared keys.
  void keep_free(const toml::table& table, const std::string& name, int line, std::vector<Found>& found) {
    DocumentValue::Table free;
    for (DocumentEntry& entry : entries_of(table)) {
      const std::string key = name + "." + entry.name;
      if (config_.schema_->find(key)) {
        found.push_back({key, table.get(entry.name), entry.line});
      } else {
        check_free(entry.value, key, config_.name_);
        free.push_back(std::move(entry));
      }
    }
    config_.free_sections_.push_back(
        {name, std::make_shared<const DocumentValue>(DocumentValue{std::move(free), line})});
  }

  void assign(const std::string& assignment) {
    Origin origin{{"--set " + shown(assignment)}, assignment};
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0) {
      fail_at(origin, "must have the form key=value");
    }
    const std::string key(trim(std::string_view(assignment).substr(0, equals)));
    const std::string text(trim(std::string_view(assignment).substr(equals + 1)));
    origin.place.key = key;
    const Key& declared = find(key, nullptr, origin);
    if (text.empty()) {
      fail_at(origin, "the value is missing; it must be " + expected_of(declared));
    }
    if (line_too_deep(text) != 0) {
      fail_at(origin, std::string(name_too_deep));
    }
    const DocumentValue bare{text, 0};
    // A line break could add further keys.
    if (text.find_first_of("\r\n") == std::string::npos && line_beyond_ascii(text) == 0) {
      try {
        const toml::table document = toml::parse("value = " + text);
        const toml::node& node = *document.get("value");
        const bool wants_text = declared.type == ValueType::text || declared.type == ValueType::choice;
        if (!wants_text || node.is_string() || node.is_array() ||
            (declared.may_be_composite && node.is_table())) {
          store(key, document_of(node, 0), origin);
          return;
        }
      } catch (const toml::parse_error&) {
        // Not TOML: an unquoted text, or a number out of toml++'s range.
        if (is_long_integer(text) &&
            (declared.type == ValueType::integer || declared.type == ValueType::real)) {
          fail_at(origin, "must be " + expected_of(declared) + " that fits in 64 bits, not " + shown(text));
        }
      }
    }
    store(key, bare, origin);
  }

  /// The declaration of `key`; throws a UserError with the nearest valid name if there is none.
  const Key& find(const std::string& key, const DocumentValue* value, const Origin& origin) const {
    const Schema& schema = *config_.schema_;
    if (const std::optional<std::size_t> index = schema.find(key)) {
      return schema.keys()[*index];
    }
    if (schema.is_section(key)) {
      const std::string keys = keys_below(key);
      fail_at(origin,
              "is a section and has no value of its own" + (keys.empty() ? "" : "; its keys are " + keys));
    }
    if (const std::string_view command = schema.elsewhere_of(key); !command.empty()) {
      fail_at(origin,
              "this command does not read it; the configuration is one for `" + std::string(command) + "`");
    }
    if (const std::string section = key.substr(0, key.find('.'));
        schema.is_free_section(section) && origin.place.line == 0) {
      const std::string keys = keys_below(section);
      fail_at(origin, "[" + section + "] can only be given in the file" +
                          (keys.empty() ? "" : ", but for its keys " + keys));
    }
    const bool is_table = value != nullptr && value->table() != nullptr;
    fail_at(origin, std::string(is_table ? "unknown section" : "unknown key") + suggestion(key) +
                        "; `marti config` lists all keys");
  }

  [[nodiscard]] std::string keys_below(const std::string& section) const {
    std::string listed;
    for (const std::string& name : config_.schema_->names()) {
      if (name.starts_with(section + ".")) {
        listed += listed.empty() ? "" : ", ";
        listed += name;
      }
    }
    return listed;
  }

  /// The key with the same last part if there is exactly one ("size": "cache.size"), else the nearest by edit
  /// distance.
  [[nodiscard]] std::string suggestion(const std::string& key) const {
    const std::string ending = "." + key.substr(key.rfind('.') + 1);
    std::vector<std::string> same;
    std::copy_if(config_.schema_->names().begin(), config_.schema_->names().end(), std::back_inserter(same),
                 [&](const std::string& name) { return name.ends_with(ending); });
    std::string near = did_you_mean(key, config_.schema_->names());
    if (near.empty() && same.size() == 1) {
      return " (did you mean \"" + same.front() + "\"?)";
    }
    return near;
  }

  void store(const std::string& key, const DocumentValue& value, const Origin& origin) {
    const Key& declared = find(key, &value, origin);
    Config::Given given;
    given.values = read_values(declared, value, origin.place);
    given.line = origin.place.line;
    given.place = origin.assignment.empty() ? "" : "--set " + origin.assignment;
    config_.entries_[*config_.schema_->find(key)].given =
        std::make_shared<const Config::Given>(std::move(given));
  }

  Config config_;
};

Config Config::from_text(const Schema& schema, std::string_view text, std::string_view name,
                         std::span<const std::string> assignments) {
  return ConfigReader(std::make_shared<const Schema>(schema), std::string(name)).read(text, assignments);
}

Config Config::from_file(const Schema& schema, const std::filesystem::path& file,
                         std::span<const std::string> assignments) {
  const std::string text = read_file(file, longest_config);
  note_input(file);
  return from_text(schema, text, file.string(), assignments);
}

}  // namespace marti::sim
