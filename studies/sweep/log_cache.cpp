#include "studies/sweep/log_cache.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <system_error>
#include <utility>
#include <vector>

#include "sim/files.h"
#include "studies/program_build.h"

namespace marti::studies {

namespace {

constexpr const char* extension = ".martilog";
constexpr std::size_t key_digits = 32;

// A half-written file has the name that sim::PendingFile gives it, and is locked by the program that writes
// it.
bool half_written(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return file.extension() == extension && name.starts_with('.') &&
         name.find_first_not_of("0123456789abcdef", 1) == key_digits + 1 &&
         name.compare(key_digits + 1, 5, ".tmp-") == 0;
}

void remove_if_left(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor >= 0) {
    struct stat status {};
    // Without a name it has been removed already, and the name may be another file's by now.
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::fstat(descriptor, &status) == 0 &&
        status.st_nlink != 0) {
      ::unlink(file.c_str());
    }
    ::close(descriptor);
  }
}

}  // namespace

LogCache::LogCache(std::filesystem::path directory) : directory_(std::move(directory)) {
  sim::make_directory(directory_);
  std::error_code error;
  for (std::filesystem::directory_iterator entry(directory_, error), end; !error && entry != end;
       entry.increment(error)) {
    if (half_written(entry->path())) {
      remove_if_left(entry->path());
    }
  }
}

std::filesystem::path LogCache::file_of(const std::string& key) const {
  return directory_ / (key + extension);
}

void LogCache::keep(const std::string& key, const FrameLog& log) const {
  sim::PendingFile pending(file_of(key));
  write_log_file(pending.temporary(), log, key, build_of_program(), [&] { pending.commit(); });
}

}  // namespace marti::studies
