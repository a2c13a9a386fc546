#include "studies/tables/run_json.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "sim/error.h"
#include "sim/files.h"

namespace marti::studies::tables {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t most_bytes = std::int64_t{256} << 20U;
constexpr int schema = 4;
// A result is far less deep, and its objects have far fewer fields.
constexpr std::size_t deepest = 32;
constexpr std::size_t most_fields = 2000;

const Json none;

[[noreturn]] void refuse(const std::string& file, const std::string& reason, MadeBy made_by = MadeBy::run) {
  throw sim::UserError(
      file + ": " + reason +
      (made_by == MadeBy::run
           ? "; expected is the result.json of `marti run CONFIG -o DIR`: run it again"
           : "; expected is a point of a sweep by this version of `marti sweep CONFIG -o DIR`: "
             "run it again in another directory"));
}

// Limits depth and number of fields: readers may walk a result by recursion, and filling an object that keeps
// its fields in order takes time quadratic in their number.
void check_shape(const std::string& file, const std::string& text) {
  std::array<std::size_t, deepest + 1> fields{};  // [depth] of the object there
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      i += c == '\\' ? 1 : 0;
      quoted = c != '"';
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      if (depth == deepest) {
        refuse(file, "is nested too deeply for a result");
      }
      fields[++depth] = 0;
    } else if (c == ':') {
      if (++fields[depth] > most_fields) {
        refuse(file, "has an object with too many fields for a result");
      }
    } else if (c == '}' || c == ']') {
      depth -= depth > 0 ? 1 : 0;
    }
  }
}

}  // namespace

const Json& RunJson::find(std::string_view path) const {
  const Json* part = &json_;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    const std::string name(path.substr(0, dot));
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
    if (!part->is_object()) {
      return none;
    }
    const auto at = part->find(name);
    if (at == part->end()) {
      return none;
    }
    part = &*at;
  }
  return *part;
}

const Json& RunJson::at(std::string_view path) const {
  const Json& part = find(path);
  if (!part.is_object()) {
    refuse("has no object \"" + std::string(path) + "\"");
  }
  return part;
}

void RunJson::refuse(const std::string& reason) const { studies::tables::refuse(file_, reason, made_by_); }

std::optional<double> RunJson::number(std::string_view path) const {
  const Json& value = find(path);
  if (!value.is_number()) {
    return std::nullopt;
  }
  const double number = value.get<double>();
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

std::optional<double> RunJson::optional_number(std::string_view path, double low, double high) const {
  if (find(path).is_null()) {
    return std::nullopt;
  }
  return required_number(path, low, high);
}

double RunJson::required_number(std::string_view path, double low, double high) const {
  const std::optional<double> found = number(path);
  if (!found || *found < low || *found > high) {
    refuse(fmt::format("has no number \"{}\" from {:g} to {:g}", path, low, high));
  }
  return *found;
}

std::string RunJson::text(std::string_view path) const {
  const Json& value = find(path);
  return value.is_string() ? value.get<std::string>() : std::string();
}

bool RunJson::boolean(std::string_view path) const {
  const Json& value = find(path);
  return value.is_boolean() && value.get<bool>();
}

std::vector<RunJson> RunJson::list(std::string_view path) const {
  std::vector<RunJson> parts;
  const Json& value = find(path);
  if (value.is_array()) {
    for (const Json& part : value) {
      if (part.is_object()) {
        parts.push_back(of(part));
      }
    }
  }
  return parts;
}

RunJson read_run_json(const std::filesystem::path& path, std::initializer_list<const char*> parts) {
  const std::string file = path.string();
  const std::string text = sim::read_file(path, most_bytes);
  check_shape(file, text);
  RunJson run(Json::parse(text, nullptr, false), file);
  if (run.json().is_discarded()) {
    refuse(file, "is not JSON");
  }
  if (!run.json().is_object()) {
    refuse(file, "is no JSON object with a number \"marti.schema\"");
  }
  const Json& found = run.find("marti.schema");
  if (!found.is_number_integer()) {
    refuse(file, "has no number \"marti.schema\"");
  }
  if (found != schema) {
    throw sim::UserError(file + ": is a result of schema " + found.dump() +
                         ", but this program reads schema " + std::to_string(schema) +
                         "; read it with the program that wrote it, or run it again");
  }
  for (const char* part : parts) {
    (void)run.at(part);
  }
  return run;
}

}  // namespace marti::studies::tables
