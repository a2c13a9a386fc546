#include "studies/sweep/spill_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "sim/error.h"

namespace marti::studies {

namespace {

// ".marti-spill-TOKEN.tmp-PID-N.lock" and ".log": what sim::PendingFile makes of a stem and an extension.
constexpr std::string_view name_start = ".marti-spill-";
constexpr std::size_t token_digits = 16;

std::string new_token() {
  std::random_device random;
  std::string token;
  for (std::size_t i = 0; i < token_digits; ++i) {
    token += "0123456789abcdef"[random() % 16];
  }
  return token;
}

std::filesystem::path target(const std::filesystem::path& directory, const std::string& token,
                             const char* extension) {
  return directory / (std::string(name_start.substr(1)) + token + extension);
}

/// The token in a name of ours with that extension; else nothing.
std::string token_in(const std::filesystem::path& file, std::string_view extension) {
  const std::string name = file.filename().string();
  const bool ours = name.starts_with(name_start) && name.ends_with(extension) &&
                    name.compare(name_start.size() + token_digits, 5, ".tmp-") == 0;
  return ours ? name.substr(name_start.size(), token_digits) : std::string();
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    files.push_back(entry->path());
  }
  return files;
}

/// Whether the program that made this lock file has ended. If so, the descriptor that is returned keeps
/// others from cleaning up at the same time; otherwise it is negative.
int lock_of_ended(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor >= 0 && ::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    ::close(descriptor);
    return -1;
  }
  return descriptor;
}

void remove_leftovers(const std::filesystem::path& directory) {
  // First the files, then the locks: a lock is made before its files, so one that is not in the second list
  // is gone for good.
  const std::vector<std::filesystem::path> before = files_in(directory);
  const std::vector<std::filesystem::path> after = files_in(directory);
  std::set<std::string> locked;
  for (const std::filesystem::path& file : after) {
    locked.insert(token_in(file, ".lock"));
  }
  const auto remove = [&](const auto& which) {
    for (const std::filesystem::path& file : before) {
      const std::string token = token_in(file, ".log");
      if (!token.empty() && which(token)) {
        ::unlink(file.c_str());
      }
    }
  };
  remove([&](const std::string& token) { return !locked.contains(token); });
  for (const std::filesystem::path& file : after) {
    const std::string token = token_in(file, ".lock");
    if (token.empty()) {
      continue;
    }
    if (const int descriptor = lock_of_ended(file); descriptor >= 0) {
      remove([&](const std::string& other) { return other == token; });
      ::unlink(file.c_str());
      ::close(descriptor);
    }
  }
}

}  // namespace

class SpillFiles::Lock {
 public:
  explicit Lock(const std::filesystem::path& directory)
      : token_(new_token()), file_(target(directory, token_, ".lock")) {
    descriptor_ = ::open(file_.temporary().c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
      throw sim::UserError(directory.string() +
                           ": work logs that do not fit in memory cannot be written there: " +
                           std::generic_category().message(errno));
    }
    // On a file system without locks it fails for everybody, so that nothing is taken for a leftover.
    taken_ = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
  }
  ~Lock() { ::close(descriptor_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

  /// Whether no other program took it for a leftover before it was locked.
  [[nodiscard]] bool held() const {
    struct stat status {};
    return taken_ && ::fstat(descriptor_, &status) == 0 && status.st_nlink > 0;
  }
  [[nodiscard]] const std::string& token() const { return token_; }

 private:
  std::string token_;
  sim::PendingFile file_;
  int descriptor_ = -1;
  bool taken_ = false;
};

SpillFiles::SpillFiles(std::filesystem::path directory) : directory_(std::move(directory)) {
  if (!directory_.empty()) {
    remove_leftovers(directory_);
  }
}

SpillFiles::~SpillFiles() = default;

std::unique_ptr<sim::PendingFile> SpillFiles::make() {
  if (directory_.empty()) {
    throw sim::UserError("the work logs do not fit in memory together, and there is no directory for them");
  }
  const std::lock_guard guard(mutex_);
  while (!lock_ || !lock_->held()) {
    lock_ = std::make_unique<Lock>(directory_);
  }
  return std::make_unique<sim::PendingFile>(target(directory_, lock_->token(), ".log"));
}

}  // namespace marti::studies
