#include "studies/tables/run_files.h"

#include <system_error>

#include "sim/error.h"
#include "sim/sha256.h"
#include "studies/tables/result_directory.h"

namespace marti::studies::tables {

namespace fs = std::filesystem;

std::span<const std::string_view> run_file_names() {
  static constexpr std::string_view names[] = {
      "image.exr",           "image.png",       "exact.exr",      "exact.png",       "heat.exr",
      "heat-cycles.png",     "heat-misses.png", "heat-waits.png", "attribution.csv", "working_set.csv",
      "working_set.vl.json", "timeline.json",   "intervals.csv",  "hits.npy"};
  return names;
}

std::map<std::string, std::string> files_of(const RunJson& run) {
  std::map<std::string, std::string> files;
  const RunJson named = run.part("files");
  for (const std::string_view name : run_file_names()) {
    if (named.json().is_object() && named.json().contains(name)) {
      files[std::string(name)] = named.of(named.json()[name]).text("sha256");
    }
  }
  return files;
}

std::map<std::string, std::string> files_of_run_in(const fs::path& directory) {
  try {
    const RunJson run = read_run_json(directory / run_name);
    std::map<std::string, std::string> files = files_of(run);
    if (!run.json().contains("files")) {
      for (const std::string_view name : run_file_names()) {
        files[std::string(name)] = "";
      }
    }
    return files;
  } catch (const sim::UserError&) {
    return {};
  }
}

void remove_run_file(const fs::path& file, const std::string& hash) {
  try {
    if (const std::string found = sim::sha256_of_file(file); hash.empty() || found == hash) {
      std::error_code stays;
      fs::remove(file, stays);
    }
  } catch (const sim::UserError&) {
    // The file is missing, or not a regular file.
  }
}

}  // namespace marti::studies::tables
