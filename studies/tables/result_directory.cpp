#include "studies/tables/result_directory.h"

#include "sim/error.h"
#include "sim/parse_number.h"

namespace marti::studies::tables {

namespace fs = std::filesystem;

bool is_there(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(file, error);
  if (status.type() == fs::file_type::not_found) {
    return false;
  }
  if (error) {
    throw sim::UserError(file.string() + ": cannot be read: " + error.message());
  }
  return true;
}

void refuse_other_results(const fs::path& directory, std::string_view own) {
  for (const char* const other : {run_name, database_name, trace_name}) {
    if (!directory.empty() && other != own && is_there(directory / other)) {
      throw sim::UserError(
          (directory / other).string() +
          ": is there already, and a directory holds a run, a sweep, a study or traces, not two of "
          "them; give another directory");
    }
  }
}

fs::path results_in(const fs::path& directory, std::string_view expected) {
  const fs::path run = directory / run_name;
  const fs::path database = directory / database_name;
  const bool is_run = is_there(run);
  if (is_run && is_there(database)) {
    throw sim::UserError(
        directory.string() +
        ": holds both a run (result.json) and a sweep or study (results.sqlite); move one of "
        "them to a directory of its own");
  }
  if (!is_run && !is_there(database)) {
    throw sim::UserError(directory.string() + ": holds neither result.json nor results.sqlite; " +
                         std::string(expected));
  }
  return is_run ? run : database;
}

std::optional<PointName> point_named(const std::string& name) {
  const std::size_t colon = name.rfind(':');
  if (colon == std::string::npos || colon + 1 == name.size()) {
    return std::nullopt;
  }
  const fs::path directory = name.substr(0, colon);
  const auto ordinal = sim::parse_number<std::int64_t>(std::string_view(name).substr(colon + 1));
  if (!ordinal || !is_there(directory)) {
    return std::nullopt;
  }
  std::error_code ignored;
  return PointName{name, fs::is_directory(directory, ignored) ? directory / database_name : directory,
                   *ordinal};
}

}  // namespace marti::studies::tables
