// The key reference, for the terminal and as Markdown.
#include <algorithm>
#include <string>
#include <string_view>

#include "sim/schema.h"

namespace marti::sim {

namespace {

/// The key's section: the longest declared section that is a prefix, else the name up to the last dot.
std::string section_of(const Schema& schema, const Key& key) {
  std::string longest;
  for (const Section& section : schema.sections()) {
    if (key.name.starts_with(section.name + ".") && section.name.size() > longest.size()) {
      longest = section.name;
    }
  }
  if (longest.empty() && key.name.find('.') != std::string::npos) {
    longest = key.name.substr(0, key.name.rfind('.'));
  }
  return longest;
}

std::string meaning_of(const Schema& schema, const std::string& section) {
  for (const Section& declared : schema.sections()) {
    if (declared.name == section) {
      return declared.meaning;
    }
  }
  return "";
}

std::string type_of(const Key& key) {
  return (key.is_list ? "list of " : "") + std::string(name_of(key.type));
}

/// What values the key takes: "1 to 64 cycles", "integer in lines, at least 1", "text". Where there is a
/// lowest and a highest value, they say what numbers these are.
std::string facts_of(const Key& key) {
  const std::string range = print_range(key);
  if (key.is_list || (key.choices.empty() && (!key.minimum || !key.maximum))) {
    return type_of(key) + (key.unit.empty() ? "" : " in " + key.unit) + (range.empty() ? "" : ", " + range);
  }
  return range + (key.unit.empty() ? "" : " " + key.unit);
}

/// `text` broken at blanks into lines of at most `width` columns, each after `indent` blanks.
std::string wrap(std::string_view text, std::size_t indent, std::size_t width) {
  std::string wrapped;
  std::string line(indent, ' ');
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, end - at);
    if (line.size() > indent && line.size() + 1 + word.size() > width) {
      wrapped += line + "\n";
      line.assign(indent, ' ');
    }
    line += line.size() > indent ? " " : "";
    line += word;
    at = end + 1;
  }
  return wrapped + line + "\n";
}

std::string escape_cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '|' ? "\\|" : std::string(1, c);
  }
  return escaped;
}

/// Calls start(section) where a new section begins and visit(key) for each key of `only`.
template <class Start, class Visit>
void for_each_key(const Schema& schema, std::string_view only, Start&& start, Visit&& visit) {
  std::string current;
  bool first = true;
  for (const Key& key : schema.keys()) {
    if (!is_or_is_below(key, only)) {
      continue;
    }
    const std::string section = section_of(schema, key);
    if (first || section != current) {
      start(section);
      current = section;
      first = false;
    }
    visit(key);
  }
}

}  // namespace

std::string list_keys_as_text(const Schema& schema, int width, std::string_view only) {
  const auto columns = static_cast<std::size_t>(std::max(width, 40));
  std::string listing;
  for_each_key(
      schema, only,
      [&](const std::string& section) {
        listing += listing.empty() ? "" : "\n";
        if (!section.empty()) {
          listing += "[" + section + "]\n";
        }
        if (const std::string meaning = meaning_of(schema, section); !meaning.empty()) {
          listing += wrap(meaning, 0, columns);
        }
      },
      [&](const Key& key) {
        listing += "  " + key.name + " = " + print_values(key, key.default_value) + "\n";
        listing += wrap(facts_of(key), 6, columns);
        listing += wrap(key.meaning, 6, columns);
      });
  return listing;
}

std::string list_keys_as_markdown(const Schema& schema) {
  std::string listing;
  for_each_key(
      schema, {},
      [&](const std::string& section) {
        listing += listing.empty() ? "" : "\n";
        if (!section.empty()) {
          listing += "## `[" + section + "]`\n\n";
        }
        if (const std::string meaning = meaning_of(schema, section); !meaning.empty()) {
          listing += meaning + "\n\n";
        }
        listing += "| key | default | values | meaning |\n|---|---|---|---|\n";
      },
      [&](const Key& key) {
        listing += "| `" + key.name + "` | `" + escape_cell(print_values(key, key.default_value)) + "` | " +
                   escape_cell(facts_of(key)) + " | " + escape_cell(key.meaning) + " |\n";
      });
  return listing;
}

}  // namespace marti::sim
