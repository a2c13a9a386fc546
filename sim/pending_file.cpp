#include "sim/pending_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <mutex>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "sim/error.h"

namespace marti::sim {

namespace {

namespace fs = std::filesystem;

// Each lock takes a file descriptor, of which a program may have about a thousand. Files beyond this number
// are not locked; their names differ so that they are not taken for leftovers of a killed program, and making
// them does not search for leftovers, because each search reads the whole directory.
constexpr std::size_t most_locks = 64;
constexpr std::string_view locked_mark = ".tmp-";
constexpr std::string_view unlocked_mark = ".part-";
constexpr std::size_t random_digits = 16;

[[noreturn]] void fail(const fs::path& file, int error) {
  throw UserError(file.string() + ": cannot be written: " + std::generic_category().message(error));
}

/// The files that are neither committed nor removed. Never destroyed: the program may end while another
/// thread uses it.
struct Pending {
  std::mutex mutex;
  std::set<const PendingFile*> files;
  std::size_t locks = 0;
};

Pending& pending() {
  static auto& all = *new Pending;  // NOLINT(cppcoreguidelines-owning-memory)
  return all;
}

std::string random_name() {
  std::array<unsigned char, random_digits / 2> bytes{};
  ensure(::getrandom(bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()),
         "the system gives no random numbers");
  std::string name;
  for (const unsigned char byte : bytes) {
    name += {"0123456789abcdef"[byte >> 4U], "0123456789abcdef"[byte & 15U]};
  }
  return name;
}

// What a temporary name begins with: as much of the target's name as leaves room for what is added to it.
std::string beginning(const fs::path& target) {
  const std::size_t added = 1 + unlocked_mark.size() + random_digits + target.extension().string().size();
  return "." + target.stem().string().substr(0, NAME_MAX - std::min<std::size_t>(added, NAME_MAX));
}

fs::path temporary_name(const fs::path& target, bool locked) {
  fs::path name = beginning(target);
  name += std::string(locked ? locked_mark : unlocked_mark) + random_name();
  name += target.extension();
  return target.parent_path() / name;
}

bool is_locked_name_of(const fs::path& target, const std::string& name) {
  const std::string begin = beginning(target) + std::string(locked_mark);
  const std::string end = target.extension().string();
  return name.size() == begin.size() + random_digits + end.size() && name.starts_with(begin) &&
         name.ends_with(end) &&
         name.substr(begin.size(), random_digits).find_first_not_of("0123456789abcdef") == std::string::npos;
}

bool is_named(int descriptor, const fs::path& file) {
  struct stat open_file {};
  struct stat named_file {};
  return ::fstat(descriptor, &open_file) == 0 && S_ISREG(open_file.st_mode) &&
         ::lstat(file.c_str(), &named_file) == 0 && open_file.st_dev == named_file.st_dev &&
         open_file.st_ino == named_file.st_ino;
}

/// Removes the temporary files of that target whose program has ended, so that their lock is free. Files that
/// cannot be opened stay.
void remove_leftovers(const fs::path& target) {
  std::error_code error;
  const fs::path directory = target.has_parent_path() ? target.parent_path() : ".";
  for (fs::directory_iterator entry(directory, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (!is_locked_name_of(target, entry->path().filename().string())) {
      continue;
    }
    // For writing, because some file systems lock exclusively only then. O_NONBLOCK: it may be a pipe.
    const Descriptor file(::open(entry->path().c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (file.get() >= 0 && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0 &&
        is_named(file.get(), entry->path())) {
      ::unlink(entry->path().c_str());
    }
  }
}

}  // namespace

PendingFile::PendingFile(fs::path target) : target_(std::move(target)) {
  std::error_code ignored;
  if (!target_.has_filename() || fs::is_directory(target_, ignored)) {
    fail(target_, EISDIR);
  }
  // A pipe or a device would be replaced by the file, not written to.
  if (const fs::file_status status = fs::status(target_, ignored);
      fs::exists(status) && !fs::is_regular_file(status)) {
    throw UserError(target_.string() + ": cannot be written: it is no regular file");
  }
  const std::lock_guard guard(pending().mutex);
  if (pending().locks < most_locks) {
    remove_leftovers(target_);
  }
  while (!make()) {
  }
  pending().files.insert(this);
  pending().locks += lock_.get() >= 0 ? 1U : 0U;
}

// Tries to make the file under a new random name; false if another name must be tried.
bool PendingFile::make() {
  const bool locked = pending().locks < most_locks;
  temporary_ = temporary_name(target_, locked);
  Descriptor file(::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) {
    if (errno == EEXIST) {
      return false;
    }
    fail(target_, errno);
  }
  device_ = status.st_dev;
  inode_ = status.st_ino;
  if (!locked) {
    return true;
  }
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) {
      return false;  // another process took it for a leftover and removes it
    }
    // A file system without locks: no other process can lock the file either.
    return true;
  }
  lock_ = std::move(file);
  return is_named(lock_.get(), temporary_);
}

PendingFile::~PendingFile() {
  const std::lock_guard guard(pending().mutex);
  pending().files.erase(this);
  pending().locks -= lock_.get() >= 0 ? 1U : 0U;
  remove();
}

void PendingFile::remove() const {
  if (!committed_ && is_ours(temporary_)) {
    ::unlink(temporary_.c_str());
  }
}

bool PendingFile::is_ours(const fs::path& file) const {
  struct stat status {};
  return ::lstat(file.c_str(), &status) == 0 && status.st_dev == device_ && status.st_ino == inode_;
}

Descriptor PendingFile::open() const {
  Descriptor file(::open(temporary_.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) {
    fail(target_, errno);
  }
  if (status.st_dev != device_ || status.st_ino != inode_) {
    fail(target_, ESTALE);
  }
  if (status.st_size != 0 && ::ftruncate(file.get(), 0) != 0) {
    fail(target_, errno);
  }
  return file;
}

void PendingFile::write(std::string_view content, Durability durability) {
  Descriptor output = open();
  if (const int error = write_all(output.get(), content); error != 0) {
    fail(target_, error);
  }
  if (durability == Durability::synced && ::fsync(output.get()) != 0) {
    fail(target_, errno);
  }
  if (output.close() != 0) {
    fail(target_, errno);
  }
}

void PendingFile::commit() {
  const std::lock_guard guard(pending().mutex);
  if (!is_ours(temporary_)) {
    throw UserError(target_.string() + ": cannot be written: another program has removed or replaced " +
                    temporary_.filename().string());
  }
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    fail(target_, errno);
  }
  committed_ = true;
}

void abandon_pending_files() {
  pending().mutex.lock();  // never unlocked: no other file can be made or committed
  for (const PendingFile* file : pending().files) {
    file->remove();
  }
}

}  // namespace marti::sim
