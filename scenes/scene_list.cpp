#include "scenes/scene_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "scenes/merged_scene.h"
#include "scenes/source_file.h"
#include "scenes/vertex_values.h"
#include "sim/config.h"
#include "sim/document.h"
#include "sim/error.h"
#include "sim/nearest.h"
#include "sim/schema.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

using sim::DocumentValue;

[[noreturn]] void fail(const std::string& entry, const std::string& message) {
  throw sim::UserError(entry + ": " + message);
}

DocumentValue parse(std::string_view spec) {
  sim::Schema schema;
  schema.free_section("scene", "");
  try {
    const sim::Config config =
        sim::Config::from_text(schema, "scene.source = " + std::string(spec), "the list");
    if (config.free_section("scene").size() != 1) {
      throw sim::UserError("something follows the list");
    }
    DocumentValue value = config.free_section("scene").front().value;
    if (value.table() != nullptr) {
      return {DocumentValue::List{std::move(value)}, 0};
    }
    return value;
  } catch (const sim::UserError& error) {
    throw sim::UserError(std::string("cannot be read as a list of scenes: ") + error.what());
  }
}

std::vector<double> numbers_of(const DocumentValue& value, const std::string& entry, const std::string& key) {
  std::vector<double> numbers;
  const auto add = [&](const DocumentValue& element) {
    const auto* const whole = std::get_if<std::int64_t>(&element.content);
    const auto* const real = std::get_if<double>(&element.content);
    const double number = whole != nullptr ? static_cast<double>(*whole) : real != nullptr ? *real : NAN;
    if (!(std::abs(number) <= largest_coordinate)) {
      fail(entry, key + " has numbers from -1e30 to 1e30, not " + describe(element));
    }
    numbers.push_back(number);
  };
  const auto* const list = value.list();
  if (list == nullptr) {
    add(value);
    return numbers;
  }
  for (const DocumentValue& element : *list) {
    if (const auto* const row = element.list()) {
      constexpr std::size_t columns = 4;
      if (row->size() != columns) {
        fail(entry, key + " has rows of " + std::to_string(columns) + " numbers, not of " +
                        std::to_string(row->size()));
      }
      for (const DocumentValue& inner : *row) {
        add(inner);
      }
    } else {
      add(element);
    }
  }
  return numbers;
}

class EntryReader {
 public:
  EntryReader(const DocumentValue& value, std::string number)
      : value_(value), entry_{{}, {}, "entry " + std::move(number)} {}

  ListedScene read() && {
    if (const std::string* const text = value_.text()) {
      set_source(*text);
    } else if (const DocumentValue::Table* const table = value_.table()) {
      read_table(*table);
    } else {
      fail(entry_.name, "must be a text or a table with source, not " + describe(value_));
    }
    return std::move(entry_);
  }

 private:
  void set_source(const std::string& text) {
    if (text.empty() || is_scene_list(text)) {
      fail(entry_.name, text.empty() ? "its source is empty" : "its source is a list itself");
    }
    entry_.source = text;
    entry_.name += ", " + sim::shown(text);
  }

  void read_table(const DocumentValue::Table& table) {
    const sim::DocumentEntry* const source = find(table, "source");
    if (source == nullptr || source->value.text() == nullptr) {
      fail(entry_.name, "lacks its source, a text that names a file, a folder or a scene");
    }
    set_source(*source->value.text());
    static const std::array<std::string, 5> known = {"source", "scale", "rotate", "translate", "matrix"};
    for (const sim::DocumentEntry& each : table) {
      if (std::find(known.begin(), known.end(), each.name) == known.end()) {
        fail(entry_.name, "unknown key " + sim::shown(each.name) + sim::did_you_mean(each.name, known) +
                              "; it may have source, scale, rotate, translate and matrix");
      }
    }
    if (table.size() == 1) {
      return;
    }
    Placement placement;
    if (const sim::DocumentEntry* const matrix = find(table, "matrix")) {
      if (table.size() > 2) {
        fail(entry_.name, "matrix takes the place of scale, rotate and translate; leave these out");
      }
      placement = matrix_of(matrix->value);
    } else {
      placement = steps_of(table);
    }
    if (is_singular(placement.linear)) {
      fail(entry_.name, "its transform is singular: it would make all flat");
    }
    entry_.placement = placement;
  }

  [[nodiscard]] Placement matrix_of(const DocumentValue& value) const {
    const std::vector<double> m = numbers_of(value, entry_.name, "matrix");
    if (m.size() != 12 && m.size() != 16) {
      fail(entry_.name, "matrix has 12 or 16 numbers, row by row, not " + std::to_string(m.size()));
    }
    if (m.size() == 16 && !(m[12] == 0.0 && m[13] == 0.0 && m[14] == 0.0 && m[15] == 1.0)) {
      fail(entry_.name, "the last row of matrix must be 0, 0, 0, 1; a matrix is written row by row here");
    }
    return {glm::dmat3({m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}), {m[3], m[7], m[11]}};
  }

  [[nodiscard]] Placement steps_of(const DocumentValue::Table& table) const {
    const glm::dvec3 scale = three(table, "scale", 1.0);
    const glm::dmat3 scaling({scale.x, 0.0, 0.0}, {0.0, scale.y, 0.0}, {0.0, 0.0, scale.z});
    return {rotation_by(three(table, "rotate", 0.0)) * scaling, three(table, "translate", 0.0)};
  }

  [[nodiscard]] glm::dvec3 three(const DocumentValue::Table& table, const std::string& key,
                                 double otherwise) const {
    const sim::DocumentEntry* const found = find(table, key);
    if (found == nullptr) {
      return glm::dvec3(otherwise);
    }
    const std::vector<double> numbers = numbers_of(found->value, entry_.name, key);
    const bool factor = key == "scale" && numbers.size() == 1;
    if (numbers.size() != 3 && !factor) {
      fail(entry_.name, key + (key == "scale" ? " is one number or three, not " : " is three numbers, not ") +
                            std::to_string(numbers.size()));
    }
    return factor ? glm::dvec3(numbers[0]) : glm::dvec3(numbers[0], numbers[1], numbers[2]);
  }

  const DocumentValue& value_;
  ListedScene entry_;
};

}  // namespace

bool is_scene_list(std::string_view spec) { return spec.starts_with('[') || spec.starts_with('{'); }

std::vector<ListedScene> read_scene_list(std::string_view spec) {
  const DocumentValue list = parse(spec);
  if (list.list()->empty() || list.list()->size() > most_parts) {
    throw sim::UserError("a list of scenes has 1 to " + std::to_string(most_parts) + " entries, not " +
                         std::to_string(list.list()->size()));
  }
  std::vector<ListedScene> entries;
  entries.reserve(list.list()->size());
  for (const DocumentValue& entry : *list.list()) {
    entries.push_back(EntryReader(entry, std::to_string(entries.size() + 1)).read());
  }
  return entries;
}

std::string scene_list_from(std::string_view spec, const std::filesystem::path& directory) {
  DocumentValue list = parse(spec);
  const auto anywhere = [&](DocumentValue& source) {
    auto* const name = std::get_if<std::string>(&source.content);
    if (name != nullptr && names_a_file(*name)) {
      *name = (directory / *name).lexically_normal().string();
    }
  };
  for (DocumentValue& entry : std::get<DocumentValue::List>(list.content)) {
    anywhere(entry);
    if (auto* const table = std::get_if<DocumentValue::Table>(&entry.content)) {
      for (sim::DocumentEntry& each : *table) {
        if (each.name == "source") {
          anywhere(each.value);
        }
      }
    }
  }
  return print_in_line(list);
}

std::string name_of_scene_list(std::string_view spec) {
  const std::vector<ListedScene> entries = read_scene_list(spec);
  return entries.front().source +
         (entries.size() == 1 ? "" : " and " + std::to_string(entries.size() - 1) + " more");
}

AnimatedScene open_scene_list(std::string_view spec, const OpenOptions& options, const ImageDecoder& decode) {
  const SourceFile whole("the list of scenes", options.file);
  MergedScene scene(whole);
  for (const ListedScene& entry : read_scene_list(spec)) {
    scene.open(entry.source, options.base_directory, decode, sim::shown(entry.source),
               entry.placement ? &*entry.placement : nullptr);
  }
  return std::move(scene).finish(name_of_scene_list(spec));
}

}  // namespace marti::scenes
