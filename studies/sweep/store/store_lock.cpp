#include "studies/sweep/store/store_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

#include "sim/error.h"

namespace marti::studies::sweep {

namespace {

// The holder of the lock, as its file names it.
std::string holder_of(int descriptor) {
  std::array<char, 300> text{};
  const ssize_t bytes = pread(descriptor, text.data(), text.size() - 1, 0);
  std::string holder(text.data(), bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
  while (!holder.empty() && holder.back() == '\n') {
    holder.pop_back();
  }
  return holder.empty() ? "another process" : holder;
}

// Whether the name still leads to the open file: its last holder may have removed it in between.
bool still_there(int descriptor, const std::filesystem::path& file) {
  struct stat open_file {};
  struct stat named_file {};
  return fstat(descriptor, &open_file) == 0 && lstat(file.c_str(), &named_file) == 0 &&
         open_file.st_dev == named_file.st_dev && open_file.st_ino == named_file.st_ino;
}

constexpr std::string_view first_word = "process ";

// The file will be written and then removed, so it must be a lock: not a link, and not somebody else's file.
std::string why_no_lock(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) {
    return std::strerror(errno);
  }
  if (!S_ISREG(status.st_mode)) {
    return "it is not a regular file";
  }
  if (status.st_nlink > 1) {
    return "it has a second name (a hard link)";
  }
  std::array<char, first_word.size()> begin{};
  const ssize_t bytes = pread(descriptor, begin.data(), begin.size(), 0);
  const bool is_lock = bytes == 0 || std::string_view(begin.data(), begin.size()) == first_word;
  return is_lock ? "" : "it is a file of something else";
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "an unknown host";
}

StoreLock::StoreLock(const std::filesystem::path& store) : file_(store.string() + ".lock") {
  do {
    // O_NONBLOCK: a pipe that nobody writes to is refused and not waited for.
    descriptor_ =
        sim::Descriptor(open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
    if (descriptor_.get() < 0 && errno != ELOOP) {
      throw sim::UserError(file_.string() + ": cannot be made: " + std::strerror(errno));
    }
    const std::string fault =
        descriptor_.get() < 0 ? "it is a symbolic link" : why_no_lock(descriptor_.get());
    if (!fault.empty()) {
      throw sim::UserError(file_.string() + ": cannot be the lock of the store: " + fault +
                           "; remove it if nothing else needs it, or give another directory");
    }
    if (flock(descriptor_.get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) {
        throw sim::UserError(store.string() + ": " + holder_of(descriptor_.get()) +
                             " is writing it; wait for it to end, or give another directory");
      }
      throw sim::UserError(file_.string() + ": cannot be locked: " + std::strerror(errno));
    }
  } while (!still_there(descriptor_.get(), file_));
  const std::string holder = std::string(first_word) + std::to_string(getpid()) + " on " + host_name() + "\n";
  // The text is only for people: on a full disk the lock holds without it.
  if (ftruncate(descriptor_.get(), 0) == 0) {
    [[maybe_unused]] const ssize_t written = pwrite(descriptor_.get(), holder.data(), holder.size(), 0);
  }
}

StoreLock::~StoreLock() { unlink(file_.c_str()); }

}  // namespace marti::studies::sweep
