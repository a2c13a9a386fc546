#include "scenes/source_file.h"

#include <system_error>
#include <utility>

#include "scenes/part_error.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/input_files.h"
#include "sim/key_error.h"
#include "sim/shown.h"

namespace marti::scenes {

SourceFile::SourceFile(std::filesystem::path path, const FileOptions& options)
    : path_(std::move(path)), options_(options), memory_(options.memory) {}

std::string SourceFile::read(std::uint64_t copies) const {
  std::error_code failed;
  if (const std::uintmax_t size = std::filesystem::file_size(path_, failed);
      !failed && size <= options_.max_file_bytes) {
    take_memory(copies * size, "it takes");
  }
  try {
    std::string bytes = sim::read_file(path_, static_cast<std::int64_t>(options_.max_file_bytes));
    sim::note_input(path_);
    return bytes;
  } catch (const sim::UserError& error) {
    const std::string reason = error.what();
    if (reason.starts_with(path_.string())) {
      throw;
    }
    fail(reason);
  }
}

void SourceFile::require_memory(std::uint64_t bytes, const char* what) const {
  try {
    memory_.require(bytes, what, "take a smaller scene");
  } catch (const sim::KeyError& error) {
    throw sim::KeyError(error.key(), sim::shown(path_.string()) + ": " + error.reason());
  }
}

void SourceFile::take_memory(std::uint64_t bytes, const char* what) const {
  require_memory(bytes, what);
  memory_.take(bytes, what, {});
}

void SourceFile::fail(const std::string& what) const {
  throw sim::UserError(sim::shown(path_.string()) + ": " + what);
}

void SourceFile::fail_empty(const std::string& what) const {
  throw NoTriangles(sim::shown(path_.string()) + ": " + what);
}

void SourceFile::fail_choice(const char* part, const std::string& what) const {
  throw PartError(part, sim::shown(path_.string()) + ": " + what);
}

}  // namespace marti::scenes
