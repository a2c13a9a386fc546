#include "sim/made_directory.h"

#include <unistd.h>

#include <system_error>

#include "sim/error.h"

namespace marti::sim {

namespace fs = std::filesystem;

MadeDirectory::MadeDirectory(const fs::path& directory) : MadeDirectory() {
  std::error_code error;
  for (fs::path missing = directory; !missing.empty() && !fs::exists(missing, error);
       missing = missing.parent_path()) {
    made_.push_back(missing);
  }
  fs::create_directories(directory, error);
  if (std::error_code ignored; fs::is_regular_file(directory, ignored)) {
    throw UserError(directory.string() + ": is a file; results need a directory, choose another name");
  }
  if (!error && !fs::is_directory(directory, error)) {
    error = std::make_error_code(std::errc::not_a_directory);
  }
  if (error) {
    throw UserError(directory.string() + ": cannot be made a directory: " + error.message());
  }
}

MadeDirectory::~MadeDirectory() {
  for (const fs::path& directory : made_) {
    (void)::rmdir(directory.c_str());  // fails for one that is not empty
  }
}

}  // namespace marti::sim
