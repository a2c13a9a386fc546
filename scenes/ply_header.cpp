#include "scenes/ply_header.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace marti::scenes {

namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr std::array<TypeName, 16> types = {{{"char", PlyType::i8},
                                             {"int8", PlyType::i8},
                                             {"uchar", PlyType::u8},
                                             {"uint8", PlyType::u8},
                                             {"short", PlyType::i16},
                                             {"int16", PlyType::i16},
                                             {"ushort", PlyType::u16},
                                             {"uint16", PlyType::u16},
                                             {"int", PlyType::i32},
                                             {"int32", PlyType::i32},
                                             {"uint", PlyType::u32},
                                             {"uint32", PlyType::u32},
                                             {"float", PlyType::f32},
                                             {"float32", PlyType::f32},
                                             {"double", PlyType::f64},
                                             {"float64", PlyType::f64}}};

/// In text the numbers of a type that PLY does not have can be read; in binary nobody knows their bytes.
PlyType type_of(const TextLines& lines, std::size_t word, const std::optional<PlyFormat>& format,
                LeftOut& left_out) {
  const auto* const found = std::find_if(
      types.begin(), types.end(), [&](const TypeName& type) { return type.name == lines.words()[word]; });
  if (found != types.end()) {
    return found->type;
  }
  const std::string reason = in_quotes(lines.words()[word]) + " is no type of PLY";
  if (format != PlyFormat::ascii) {
    lines.fail(reason);
  }
  left_out.replace("types of properties that PLY does not have, by double", lines.refusal(reason));
  return PlyType::f64;
}

void need_words(const TextLines& lines, std::size_t count, const char* form) {
  if (lines.words().size() != count) {
    lines.fail("the line must be '" + std::string(form) + "'");
  }
}

PlyFormat format_of(const TextLines& lines) {
  need_words(lines, 3, "format NAME 1.0");
  constexpr std::array<std::string_view, 3> names = {"ascii", "binary_little_endian", "binary_big_endian"};
  const auto* const found = std::find(names.begin(), names.end(), lines.words()[1]);
  if (found == names.end()) {
    lines.fail("there is no format " + in_quotes(lines.words()[1]) +
               ", only ascii, binary_little_endian and binary_big_endian");
  }
  if (lines.words()[2] != "1.0") {
    lines.fail("version " + in_quotes(lines.words()[2]) + " is not supported, only 1.0");
  }
  return static_cast<PlyFormat>(found - names.begin());
}

PlyElement element_of(const TextLines& lines, const PlyHeader& header, std::size_t size) {
  need_words(lines, 3, "element NAME COUNT");
  PlyElement element;
  element.name = lines.words()[1];
  const std::int64_t count = lines.integer(lines.words()[2]);
  // Each entry takes a byte at least, because it has a property.
  if (count < 0 || static_cast<std::uint64_t>(count) > size) {
    lines.fail("the file has " + std::to_string(size) + " bytes, which cannot be " + std::to_string(count) +
               " entries of the element " + in_quotes(element.name));
  }
  element.count = static_cast<std::uint64_t>(count);
  if (std::any_of(header.elements.begin(), header.elements.end(),
                  [&](const PlyElement& other) { return other.name == element.name; })) {
    lines.fail("the element " + in_quotes(element.name) + " is declared a second time");
  }
  return element;
}

PlyProperty property_of(const TextLines& lines, const PlyHeader& header,
                        const std::optional<PlyFormat>& format, LeftOut& left_out) {
  if (header.elements.empty()) {
    lines.fail("a property before the first element");
  }
  PlyProperty property;
  if (lines.words().size() > 1 && lines.words()[1] == "list") {
    need_words(lines, 5, "property list TYPE TYPE NAME");
    property.count = type_of(lines, 2, format, left_out);
    if (!is_integer(*property.count)) {
      lines.fail("the length of a list must be of an integer type, not " + in_quotes(lines.words()[2]));
    }
  } else {
    need_words(lines, 3, "property TYPE NAME");
  }
  property.type = type_of(lines, lines.words().size() - 2, format, left_out);
  property.name = lines.words().back();
  if (header.elements.back().find(property.name)) {
    lines.fail("the property " + in_quotes(property.name) + " is declared a second time");
  }
  return property;
}

void require_properties(const TextLines& lines, const PlyHeader& header) {
  if (!header.elements.empty() && header.elements.back().properties.empty()) {
    lines.fail("the element " + in_quotes(header.elements.back().name) + " has no properties");
  }
}

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> sizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

bool is_integer(PlyType type) { return type < PlyType::f32; }

std::optional<std::size_t> PlyElement::find(std::string_view property) const {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const PlyProperty& p) { return p.name == property; });
  return found == properties.end() ? std::nullopt
                                   : std::optional(static_cast<std::size_t>(found - properties.begin()));
}

PlyHeader read_ply_header(TextLines& lines, std::size_t size, LeftOut& left_out) {
  constexpr std::size_t most_declarations = 1000;
  if (!lines.next() || lines.words().size() != 1 || lines.words()[0] != "ply" || lines.line() != 1) {
    lines.fail("it does not begin with the line 'ply'");
  }
  PlyHeader header;
  std::optional<PlyFormat> format;
  std::size_t declarations = 0;
  while (lines.next()) {
    const std::string_view word = lines.words().front();
    if (word == "end_header") {
      require_properties(lines, header);
      if (!format) {
        lines.fail("the header says no format");
      }
      header.format = *format;
      return header;
    }
    if (word == "comment" || word == "obj_info") {
      continue;
    }
    if (++declarations > most_declarations) {
      lines.fail("the header has more than " + std::to_string(most_declarations) + " declarations");
    }
    if (word == "format") {
      if (format) {
        lines.fail("the format is given a second time");
      }
      format = format_of(lines);
    } else if (word == "element") {
      require_properties(lines, header);
      header.elements.push_back(element_of(lines, header, size));
    } else if (word == "property") {
      PlyProperty property = property_of(lines, header, format, left_out);
      header.elements.back().properties.push_back(std::move(property));
    } else {
      left_out.replace("lines of the header that are no statement of PLY, by none",
                       lines.refusal(in_quotes(word) + " is no statement of a PLY header"));
    }
  }
  lines.fail("the file ends before the line 'end_header'");
}

}  // namespace marti::scenes
