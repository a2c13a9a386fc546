#include "studies/report/chart_check.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "sim/error.h"

namespace marti::studies {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A chart of marti has some hundred values beside its rows. The cost of each grows with the number of rows,
// or faster.
constexpr std::size_t most_values = 2000;
constexpr int deepest = 32;

/// The kinds of parts that a specification has, by what may stand in them.
enum class Part : std::uint8_t {
  view,
  data,
  transform,
  aggregate,
  mark,
  encoding,
  channel,
  axis,
  scale,
  sort,
  size,
  resolve,
  resolved,
  plain,       // numbers, texts, true, false, null, or a list of them
  expression,  // a text that Vega evaluates
  format,      // of a number, as d3-format has it
  base         // of a logarithmic scale
};

struct Field {
  std::string_view name;
  Part part;
};

std::span<const Field> fields_of(Part part) {
  using enum Part;
  static constexpr Field view_fields[] = {
      {"$schema", plain},     {"title", plain}, {"description", plain}, {"data", data},
      {"width", size},        {"height", size}, {"mark", mark},         {"transform", transform},
      {"encoding", encoding}, {"layer", view},  {"concat", view},       {"hconcat", view},
      {"vconcat", view},      {"spec", view},   {"facet", channel},     {"columns", plain},
      {"resolve", resolve}};
  static constexpr Field transform_fields[] = {{"calculate", expression}, {"filter", expression},
                                               {"fold", plain},           {"aggregate", aggregate},
                                               {"groupby", plain},        {"as", plain}};
  static constexpr Field aggregate_fields[] = {{"op", plain}, {"field", plain}, {"as", plain}};
  static constexpr Field mark_fields[] = {
      {"type", plain},   {"point", plain},       {"color", plain},      {"opacity", plain},
      {"filled", plain}, {"size", plain},        {"strokeDash", plain}, {"strokeWidth", plain},
      {"clip", plain},   {"interpolate", plain}, {"align", plain},      {"baseline", plain},
      {"dx", plain},     {"dy", plain},          {"fontSize", plain}};
  static constexpr Field encoding_fields[] = {
      {"x", channel},       {"y", channel},       {"x2", channel},    {"y2", channel},
      {"xOffset", channel}, {"yOffset", channel}, {"color", channel}, {"shape", channel},
      {"size", channel},    {"opacity", channel}, {"order", channel}, {"text", channel},
      {"detail", channel},  {"tooltip", channel}, {"row", channel},   {"column", channel}};
  static constexpr Field channel_fields[] = {
      {"field", plain}, {"type", plain},  {"title", plain},  {"aggregate", plain}, {"stack", plain},
      {"value", plain}, {"datum", plain}, {"sort", sort},    {"axis", axis},       {"scale", scale},
      {"legend", axis}, {"header", axis}, {"format", format}};
  static constexpr Field axis_fields[] = {
      {"title", plain},           {"format", format},    {"grid", plain},         {"orient", plain},
      {"labelAngle", plain},      {"labelLimit", plain}, {"labelOverlap", plain}, {"labelSeparation", plain},
      {"labelFontWeight", plain}, {"tickMinStep", plain}};
  static constexpr Field scale_fields[] = {{"type", plain}, {"domain", plain}, {"range", plain},
                                           {"base", base},  {"zero", plain},   {"nice", plain}};
  static constexpr Field sort_fields[] = {{"field", plain}, {"op", plain}, {"order", plain}};
  static constexpr Field size_fields[] = {{"step", plain}};
  static constexpr Field resolve_fields[] = {{"scale", resolved}, {"axis", resolved}, {"legend", resolved}};
  static constexpr Field resolved_fields[] = {{"x", plain},     {"y", plain},    {"color", plain},
                                              {"shape", plain}, {"size", plain}, {"opacity", plain}};
  switch (part) {
    case view:
      return view_fields;
    case transform:
      return transform_fields;
    case aggregate:
      return aggregate_fields;
    case mark:
      return mark_fields;
    case encoding:
      return encoding_fields;
    case channel:
      return channel_fields;
    case axis:
      return axis_fields;
    case scale:
      return scale_fields;
    case sort:
      return sort_fields;
    case size:
      return size_fields;
    case resolve:
      return resolve_fields;
    case resolved:
      return resolved_fields;
    default:
      return {};
  }
}

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '$'; }

// What an expression calls beside arithmetic functions: sequence(0, 1e9) alone would take all of the memory.
// Also found is what could hide a call from this search of the text: a regular expression, which may hold
// quotes, and an escape outside of quotes. Empty when there is none.
std::string foreign_call(std::string_view text) {
  constexpr std::string_view allowed[] = {"abs",     "ceil", "exp", "floor", "if",  "isFinite", "isNaN",
                                          "isValid", "log",  "max", "min",   "pow", "round",    "sqrt"};
  constexpr std::string_view operators[] = {"delete", "in", "instanceof", "new", "typeof", "void"};
  const auto is_in = [](const auto& names, std::string_view name) {
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
  };
  std::string_view name;  // that comes before i
  bool operand = false;   // comes before i
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '(' && operand && !is_in(allowed, name)) {
      return name.empty() ? "what another expression gives" : std::string(name);
    }
    if (c == '\\' || (c == '/' && !operand)) {
      return "something by \"" + std::string(text.substr(i, 20)) + "\"";
    }
    if (c == '\'' || c == '"') {
      for (++i; i < text.size() && text[i] != c; ++i) {
        i += text[i] == '\\' ? 1 : 0;
      }
    } else if (is_letter(c)) {
      const std::size_t begin = i;
      while (i + 1 < text.size() && is_letter(text[i + 1])) {
        ++i;
      }
      name = text.substr(begin, i + 1 - begin);
      operand = !is_in(operators, name);
      continue;
    } else if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
      continue;
    }
    name = {};
    operand = c == ')' || c == ']' || c == '\'' || c == '"';
  }
  return {};
}

class Check {
 public:
  explicit Check(const fs::path& file) : file_(file) {}

  void part(Part kind, const Json& value, const std::string& path, int depth) {
    if (++values_ > most_values || depth > deepest) {
      refuse("has more parts than a chart of marti");
    }
    if (kind == Part::data) {
      data(value, path);
    } else if (value.is_array()) {
      list(kind, value, path, depth);
    } else if (value.is_object()) {
      object(kind, value, path, depth);
    } else {
      leaf(kind, value, path);
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw sim::UserError(file_.string() + ": " + reason + "; remove it, or make the results again");
  }

  void object(Part kind, const Json& value, const std::string& path, int depth) {
    const std::span<const Field> fields = fields_of(kind);
    for (const auto& [name, each] : value.items()) {
      const std::string inner = path.empty() ? name : path + "." + name;
      const auto field = std::find_if(fields.begin(), fields.end(),
                                      [&wanted = name](const Field& f) { return f.name == wanted; });
      if (field == fields.end()) {
        refuse("has \"" + inner.substr(0, 200) + "\", which a chart of marti has not");
      }
      part(field->part, each, inner, depth + 1);
      if (kind == Part::mark && name == "type") {
        mark_type(each, inner);
      }
    }
  }

  void list(Part kind, const Json& value, const std::string& path, int depth) {
    std::size_t index = 0;
    for (const Json& each : value) {
      part(kind, each, path + "[" + std::to_string(index++) + "]", depth + 1);
    }
  }

  void leaf(Part kind, const Json& value, const std::string& path) const {
    if (kind == Part::mark) {
      mark_type(value, path);
    } else if (kind == Part::expression && value.is_string()) {
      if (const std::string name = foreign_call(value.get_ref<const std::string&>()); !name.empty()) {
        refuse("calls " + name.substr(0, 200) + " in \"" + path + "\", which a chart of marti does not");
      }
    } else if (kind == Part::format && value.is_string()) {
      // Its numbers are widths and precisions.
      const auto& text = value.get_ref<const std::string&>();
      if (std::count_if(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }) > 2) {
        refuse("has a format in \"" + path + "\" of more than two digits");
      }
    } else if (kind == Part::base && (!value.is_number() || value.get<double>() < 2.0)) {
      refuse("has a base in \"" + path + "\" that is no number from 2 on");  // below, ticks without number
    }
  }

  // An image is loaded, and a shape of a map projected.
  void mark_type(const Json& value, const std::string& path) const {
    constexpr std::string_view types[] = {"area", "bar",    "circle", "line", "point", "rect",
                                          "rule", "square", "text",   "tick", "trail"};
    if (!value.is_object() &&
        (!value.is_string() || std::find(std::begin(types), std::end(types),
                                         value.get_ref<const std::string&>()) == std::end(types))) {
      refuse("has a mark in \"" + path + "\" that a chart of marti has not");
    }
  }

  // Rows are numbers and texts, whatever their columns are called.
  void data(const Json& value, const std::string& path) const {
    if (value.is_null()) {
      return;
    }
    if (!value.is_object()) {
      refuse("has data in \"" + path + "\" that are no object");
    }
    for (const auto& [name, each] : value.items()) {
      if (name != "values" && name != "name") {
        refuse("has data by \"" + path + "." + name.substr(0, 200) +
               "\"; a chart's data are rows under data.values");
      }
    }
    const auto rows = value.find("values");
    if (rows == value.end()) {
      return;
    }
    if (!rows->is_array()) {
      refuse("has no rows under \"" + path + ".values\"");
    }
    for (const Json& row : *rows) {
      if (!row.is_object() ||
          std::any_of(row.begin(), row.end(), [](const Json& cell) { return cell.is_structured(); })) {
        refuse("has rows under \"" + path + ".values\" that are no objects of numbers and texts");
      }
    }
  }

  const fs::path& file_;
  std::size_t values_ = 0;
};

}  // namespace

void check_chart(const fs::path& file, const Json& chart) { Check(file).part(Part::view, chart, "", 0); }

}  // namespace marti::studies
