#include "studies/report/read/report_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/files.h"
#include "sim/units.h"

namespace marti::studies::report {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::int64_t largest_image = std::int64_t{16} << 20U;
constexpr std::int64_t largest_chart = std::int64_t{8} << 20U;

[[noreturn]] void refuse(const fs::path& file, const std::string& reason) {
  throw sim::UserError(file.string() + ": " + reason + "; remove it, or make the results again");
}

// Big-endian, as PNG has its numbers.
std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    number = number << 8U | static_cast<unsigned char>(bytes[at + i]);
  }
  return number;
}

void check_png(const fs::path& file, std::string_view png) {
  using namespace std::string_view_literals;
  // Signature, length and name of the chunk of sizes; width, height.
  constexpr std::string_view begin = "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR"sv;
  constexpr std::string_view end = "\0\0\0\0IEND\xae\x42\x60\x82"sv;
  constexpr std::uint32_t largest = 32768;  // image.width, image.height
  if (!png.starts_with(begin) || png.size() < begin.size() + 8) {
    refuse(file, "is no PNG file");
  }
  const std::uint32_t width = number_at(png, begin.size());
  const std::uint32_t height = number_at(png, begin.size() + 4);
  if (width == 0 || height == 0 || width > largest || height > largest) {
    refuse(file, "is a PNG file of " + std::to_string(width) + " x " + std::to_string(height) +
                     " pixels, which no image of marti has");
  }
  if (!png.ends_with(end)) {
    refuse(file, "is a PNG file without its end");
  }
}

}  // namespace

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
  std::ranges::sort(files);
  return files;
}

void take_image(const fs::path& file, const std::string& title, ReportData& report,
                const std::string& scale) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (!error && size > static_cast<std::uintmax_t>(largest_image)) {
    report.answer.push_back(file.filename().string() + " is left out of this page: it has more than " +
                            sim::print_size(largest_image) + ".");
    return;
  }
  ReportImage image{file.stem().string(), title, sim::read_file(file, largest_image), scale};
  check_png(file, image.png);
  report.images.push_back(std::move(image));
}

Json read_chart_rows(const fs::path& file) {
  const Json chart = Json::parse(sim::read_file(file, largest_chart), nullptr, false);
  const Json::json_pointer place("/data/values");
  if (!chart.is_object() || !chart.contains(place) || !chart[place].is_array()) {
    refuse(file, "has no rows under data.values");
  }
  for (const Json& row : chart[place]) {
    if (!row.is_object() || std::ranges::any_of(row, [](const Json& cell) { return cell.is_structured(); })) {
      refuse(file, "has rows under data.values that are no objects of numbers and texts");
    }
  }
  return chart[place];
}

}  // namespace marti::studies::report
