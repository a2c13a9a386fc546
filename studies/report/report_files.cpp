#include "studies/report/report_files.h"

#include <algorithm>

#include "sim/error.h"
#include "sim/files.h"
#include "studies/report/rows_csv.h"

namespace marti::studies {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::int64_t largest_image = std::int64_t{16} << 20U;
constexpr std::int64_t largest_chart = std::int64_t{8} << 20U;
constexpr int deepest = 64;

[[noreturn]] void refuse(const fs::path& file, const std::string& reason) {
  throw sim::UserError(file.string() + ": " + reason + "; remove it, or make the results again");
}

// Names by which a specification can load data, pictures or pages.
bool asks_for_more(const Json& part, int depth) {
  if (depth > deepest) {
    return true;
  }
  if (part.is_object()) {
    return std::any_of(part.items().begin(), part.items().end(), [depth](const auto& item) {
      return item.key() == "url" || item.key() == "href" || asks_for_more(item.value(), depth + 1);
    });
  }
  return part.is_array() && std::any_of(part.begin(), part.end(),
                                        [depth](const Json& each) { return asks_for_more(each, depth + 1); });
}

// A name as tables and charts have it.
std::string plain(std::string name) {
  for (char& c : name) {
    const bool kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    c = kept ? c : '_';
  }
  return name;
}

std::string text_in(const Json& spec, const char* name) {
  const auto at = spec.find(name);
  return at != spec.end() && at->is_string() ? at->get<std::string>() : std::string();
}

}  // namespace

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

std::vector<fs::path> files_ending_in(const fs::path& directory, std::string_view ending) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (entry->path().filename().string().ends_with(ending)) {
      files.push_back(entry->path());
    }
  }
  if (error) {
    throw sim::UserError(directory.string() + ": cannot be read: " + error.message());
  }
  std::sort(files.begin(), files.end());
  return files;
}

ReportImage read_image(const fs::path& file, const std::string& title) {
  ReportImage image{file.stem().string(), title, sim::read_file(file, largest_image)};
  if (!image.png.starts_with("\x89PNG\r\n\x1a\n")) {
    refuse(file, "is no PNG file");
  }
  return image;
}

ReportChart read_chart(const fs::path& file) {
  ReportChart chart;
  chart.spec = Json::parse(sim::read_file(file, largest_chart), nullptr, false);
  if (!chart.spec.is_object() || text_in(chart.spec, "$schema").find("vega-lite") == std::string::npos) {
    refuse(file, "is no Vega-Lite specification");
  }
  const auto data = chart.spec.find("data");
  if (data == chart.spec.end() || !data->is_object() || !data->contains("values") ||
      !data->at("values").is_array()) {
    refuse(file, "has no rows under data.values");
  }
  const Json& rows = data->at("values");
  if (!std::all_of(rows.begin(), rows.end(), [](const Json& row) { return row.is_object(); })) {
    refuse(file, "has rows under data.values that are no objects");
  }
  Json rest = chart.spec;
  rest.erase("data");
  rest.erase("$schema");
  if (asks_for_more(rest, 0)) {
    refuse(file, "asks for something outside of the file (url or href), or is nested too deeply");
  }
  const std::string name = file.filename().string();
  chart.name = plain(name.substr(0, name.find(".vl.json")));
  chart.title = text_in(chart.spec, "title");
  chart.title = chart.title.empty() ? chart.name : chart.title;
  chart.csv = csv_of_rows(rows);
  return chart;
}

}  // namespace marti::studies
