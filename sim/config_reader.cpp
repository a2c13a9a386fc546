// Reading a Config: TOML through toml++, which no other file of the project includes.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include <toml++/toml.h>

#include "sim/config.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/nearest.h"
#include "sim/toml_text.h"
#include "sim/units.h"

namespace marti::sim {

namespace {

constexpr std::int64_t longest_file = 1 << 20;
// toml++ follows tables with recursive calls and bounds only the depth of values: a key of 100,000 parts
// would overflow its stack.
constexpr std::size_t most_key_parts = 32;

struct Origin {
  std::string place;  // how a message begins: "file:line: key" or "--set key=value"
  int line = 0;
  std::string assignment;
};

[[noreturn]] void fail_at(const Origin& origin, const std::string& message) {
  throw UserError(origin.place + ": " + message);
}

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
         c == '"' || c == '\'';
}

/// Refuses dotted names of too many parts, before toml++ sees them.
void check_depth(std::string_view text, std::string_view name) {
  std::size_t line = 1;
  std::size_t parts = 0;
  bool after_dot = true;  // a further dot would not separate two parts of a name
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
      throw UserError(std::string(name) + ":" + std::to_string(line) + ": a name has more than " +
                      std::to_string(most_key_parts) + " parts joined by dots");
    }
  }
}

std::string describe(const toml::node& node) {
  std::ostringstream out;
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      out << "the text \"" << node.ref<std::string>().substr(0, 60) << "\"";
      return out.str();
    case toml::node_type::integer:
      return "the integer " + std::to_string(node.ref<std::int64_t>());
    case toml::node_type::floating_point:
      out << "the real " << node.ref<double>();
      return out.str();
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

std::string expectation(const Key& key) {
  switch (key.type) {
    case ValueType::boolean:
      return "true or false";
    case ValueType::integer:
      return "an integer";
    case ValueType::real:
      return "a number";
    case ValueType::text:
      return "a text in quotation marks";
    case ValueType::choice:
      return print_range(key);
    case ValueType::size:
      return "a size such as \"16 KiB\"";
    case ValueType::frequency:
      return "a frequency such as \"33 MHz\"";
    case ValueType::duration:
      return "a duration such as \"10 ns\"";
    case ValueType::percentage:
      return "a percentage such as \"42 %\"";
  }
  throw InternalError("unknown type of value");
}

}  // namespace

/// Builds one Config. Everything wrong is thrown at once, in the order of the text.
class ConfigReader {
 public:
  ConfigReader(const Schema& schema, std::string name) : config_(schema, std::move(name)) {}

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
    check_depth(text, config_.name_);
    if (const std::size_t line = line_beyond_ascii(text); line != 0) {
      throw UserError(config_.name_ + ":" + std::to_string(line) +
                      ": a character that is not ASCII, outside of a text in quotes and of a comment");
    }
    try {
      const toml::table document = toml::parse(text, config_.name_);
      std::vector<Found> found;
      flatten(document, "", found);
      std::stable_sort(found.begin(), found.end(),
                       [](const Found& a, const Found& b) { return a.line < b.line; });
      for (const Found& one : found) {
        const Origin origin{config_.name_ + ":" + std::to_string(one.line) + ": " + one.key, one.line, {}};
        store(one.key, *one.node, origin);
      }
    } catch (const toml::parse_error& error) {
      const toml::source_position at = error.source().begin;
      std::ostringstream message;
      message << config_.name_ << ":" << at.line << ":" << at.column << ": " << error.description();
      throw UserError(message.str());
    }
  }

  /// Lists the values below `table` under their dotted names. A table without values stands for itself.
  void flatten(const toml::table& table, const std::string& prefix, std::vector<Found>& found) const {
    for (const auto& [key, node] : table) {
      // A part that has dots itself would look like several: it is shown in quotation marks and unknown.
      const bool plain = key.str().find('.') == std::string_view::npos && !key.str().empty();
      const std::string part = plain ? std::string(key.str()) : "\"" + std::string(key.str()) + "\"";
      const std::string name = prefix.empty() ? part : prefix + "." + part;
      const toml::table* inner = node.as_table();
      // An empty section of a known name says nothing and does no harm.
      if (inner != nullptr && !config_.schema_.find(name)) {
        if (!inner->empty()) {
          flatten(*inner, name, found);
          continue;
        }
        if (config_.schema_.is_section(name)) {
          continue;
        }
      }
      found.push_back({name, &node, static_cast<int>(key.source().begin.line)});
    }
  }

  void assign(const std::string& assignment) {
    Origin origin{"--set " + assignment.substr(0, 200), 0, assignment};
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0) {
      fail_at(origin, "must have the form key=value");
    }
    const std::string key = trim(assignment.substr(0, equals));
    const std::string text = trim(assignment.substr(equals + 1));
    const Key& declared = find(key, nullptr, origin);
    if (text.empty()) {
      fail_at(origin, "the value is missing; it must be " + expected(declared));
    }
    check_depth(text, origin.place);
    const toml::value<std::string> bare(text);
    // A line break could smuggle in further keys.
    if (text.find_first_of("\r\n") == std::string::npos && line_beyond_ascii(text) == 0) {
      try {
        const toml::table document = toml::parse("value = " + text);
        const toml::node& node = *document.get("value");
        const bool wants_text = declared.type == ValueType::text || declared.type == ValueType::choice;
        if (!wants_text || node.is_string() || node.is_array()) {
          store(key, node, origin);
          return;
        }
      } catch (const toml::parse_error&) {
        // Not TOML: a bare text.
      }
    }
    store(key, bare, origin);
  }

  static std::string trim(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
  }

  static std::string expected(const Key& key) {
    return key.is_list ? "a list in brackets, each " + expectation(key) : expectation(key);
  }

  /// The declaration of `key`, or a UserError that knows the nearest valid name.
  const Key& find(const std::string& key, const toml::node* node, const Origin& origin) const {
    const Schema& schema = config_.schema_;
    if (const std::optional<std::size_t> index = schema.find(key)) {
      return schema.keys()[*index];
    }
    if (schema.is_section(key)) {
      fail_at(origin, "is a section and has no value of its own; its keys are " + keys_below(key));
    }
    const bool is_table = node != nullptr && node->is_table();
    fail_at(origin, std::string(is_table ? "unknown section" : "unknown key") + suggestion(key) +
                        "; `marti config` lists all keys");
  }

  [[nodiscard]] std::string keys_below(const std::string& section) const {
    std::string listed;
    for (const std::string& name : config_.schema_.names()) {
      if (name.starts_with(section + ".")) {
        listed += listed.empty() ? "" : ", ";
        listed += name;
      }
    }
    return listed;
  }

  /// The key of the same last part when there is just one such key ("size": "cache.size"), else the
  /// nearest by edit distance.
  [[nodiscard]] std::string suggestion(const std::string& key) const {
    const std::string ending = "." + key.substr(key.rfind('.') + 1);
    std::vector<std::string> same;
    std::copy_if(config_.schema_.names().begin(), config_.schema_.names().end(), std::back_inserter(same),
                 [&](const std::string& name) { return name.ends_with(ending); });
    std::string near = did_you_mean(key, config_.schema_.names());
    if (near.empty() && same.size() == 1) {
      return " (did you mean \"" + same.front() + "\"?)";
    }
    return near;
  }

  void store(const std::string& key, const toml::node& node, const Origin& origin) {
    const Key& declared = find(key, &node, origin);
    std::vector<Value> values;
    if (declared.is_list) {
      const toml::array* list = node.as_array();
      if (list == nullptr) {
        fail_at(origin, "must be " + expected(declared) + ", not " + describe(node));
      }
      for (const toml::node& element : *list) {
        values.push_back(convert(declared, element, origin));
      }
    } else {
      values.push_back(convert(declared, node, origin));
    }
    Config::Entry& entry = config_.entries_[*config_.schema_.find(key)];
    entry.values = std::move(values);
    entry.given = true;
    entry.line = origin.line;
    entry.assignment = origin.assignment;
  }

  static Value convert(const Key& key, const toml::node& node, const Origin& origin) {
    Value value = typed(key, node, origin);
    if (!in_range(key, value)) {
      std::string message = "must be " + print_range(key);
      if (!key.unit.empty()) {
        message += " (" + key.unit + ")";
      }
      message += ", not " + print_value(key.type, value);
      if (key.type == ValueType::choice) {
        message += did_you_mean(std::get<std::string>(value), key.choices);
      }
      fail_at(origin, message);
    }
    return value;
  }

  /// The node as the key's type, its range not yet checked.
  static Value typed(const Key& key, const toml::node& node, const Origin& origin) {
    const auto wrong = [&]() { fail_at(origin, "must be " + expectation(key) + ", not " + describe(node)); };
    const auto parsed = [&](auto parse) -> Value {
      try {
        return parse(node.ref<std::string>());
      } catch (const UserError& error) {
        fail_at(origin, error.what());
      }
    };
    switch (key.type) {
      case ValueType::boolean:
        if (node.is_boolean()) {
          return node.ref<bool>();
        }
        break;
      case ValueType::integer:
        if (node.is_integer()) {
          return node.ref<std::int64_t>();
        }
        break;
      case ValueType::real:
        return real(node, wrong);
      case ValueType::text:
      case ValueType::choice:
        if (node.is_string()) {
          return node.ref<std::string>();
        }
        break;
      case ValueType::size:
        if (node.is_integer() && node.ref<std::int64_t>() >= 0) {
          return node.ref<std::int64_t>();
        }
        if (node.is_string()) {
          return parsed([](const std::string& text) { return parse_size(text); });
        }
        break;
      case ValueType::frequency:
        if (node.is_string()) {
          return parsed([](const std::string& text) { return parse_frequency(text); });
        }
        break;
      case ValueType::duration:
        if (node.is_string()) {
          return parsed([](const std::string& text) { return std::int64_t{parse_duration(text)}; });
        }
        break;
      case ValueType::percentage:
        if (node.is_string()) {
          return parsed([](const std::string& text) { return parse_percentage(text); });
        }
        break;
    }
    wrong();
    throw InternalError("a value of the wrong type was accepted");
  }

  template <class Wrong>
  static Value real(const toml::node& node, const Wrong& wrong) {
    double value = 0;
    if (node.is_integer()) {
      value = static_cast<double>(node.ref<std::int64_t>());
      if (std::abs(value) > 0x1p53) {  // not every integer beyond is a double
        wrong();
      }
    } else if (node.is_floating_point()) {
      value = node.ref<double>();
    } else {
      wrong();
    }
    if (!std::isfinite(value)) {
      wrong();
    }
    return value;
  }

  Config config_;
};

Config Config::from_text(const Schema& schema, std::string_view text, std::string_view name,
                         std::span<const std::string> assignments) {
  return ConfigReader(schema, std::string(name)).read(text, assignments);
}

Config Config::from_file(const Schema& schema, const std::filesystem::path& file,
                         std::span<const std::string> assignments) {
  return from_text(schema, read_file(file, longest_file), file.string(), assignments);
}

}  // namespace marti::sim
