#include "studies/tables/result_directory.h"

#include <string>

#include "sim/error.h"

namespace marti::studies {

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

fs::path results_in(const fs::path& directory, std::string_view expected) {
  const fs::path run = directory / "result.json";
  const fs::path database = directory / "results.sqlite";
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

}  // namespace marti::studies
