#include "sim/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "sim/error.h"
#include "sim/units.h"

namespace marti::sim {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, std::string_view what, int error) {
  throw UserError(file.string() + ": " + std::string(what) + ": " + std::generic_category().message(error));
}

/// Closes a file descriptor; close() is called explicitly where its error matters.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) {
      ::close(number_);
    }
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return number_; }
  int close() { return ::close(std::exchange(number_, -1)); }

 private:
  int number_;
};

/// A name in the target's directory that no other process and no other call in this process takes.
std::filesystem::path temporary_name(const std::filesystem::path& target) {
  static std::atomic<unsigned> counter{0};
  std::filesystem::path name = ".";
  name += target.stem();
  name += ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
  name += target.extension();
  return target.parent_path() / name;
}

/// The temporary names that are in use. Never destroyed: a program may end while another thread looks.
struct PendingNames {
  std::mutex lock;
  std::set<std::filesystem::path> names;
};

PendingNames& pending_names() {
  static auto& pending = *new PendingNames;  // NOLINT(cppcoreguidelines-owning-memory)
  return pending;
}

void write_all(const std::filesystem::path& file, int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0) {
      if (errno == EINTR) {
        continue;
      }
      fail(file, "cannot be written", errno);
    }
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

std::string read_file(const std::filesystem::path& file, std::int64_t max_bytes) {
  // O_NONBLOCK: opening a pipe nobody writes to must fail below and not wait for ever.
  Descriptor input(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (input.get() < 0) {
    fail(file, "cannot be read", errno);
  }
  struct stat status {};
  if (::fstat(input.get(), &status) != 0) {
    fail(file, "cannot be read", errno);
  }
  if (S_ISDIR(status.st_mode)) {
    fail(file, "cannot be read", EISDIR);
  }
  if (!S_ISREG(status.st_mode)) {
    throw UserError(file.string() + ": cannot be read: not a regular file");
  }
  std::string content;
  const auto too_long = [&] {
    throw UserError(file.string() + ": is too long: more than " + print_size(max_bytes));
  };
  if (status.st_size > max_bytes) {
    too_long();
  }
  // One byte more than expected shows the end, also of files (in /proc) that state no size.
  content.resize(static_cast<std::size_t>(status.st_size) + 1);
  std::size_t length = 0;
  while (true) {
    if (length == content.size()) {
      content.resize(2 * content.size());
    }
    const ssize_t count = ::read(input.get(), content.data() + length, content.size() - length);
    if (count < 0) {
      if (errno == EINTR) {
        continue;
      }
      fail(file, "cannot be read", errno);
    }
    if (count == 0) {
      break;
    }
    length += static_cast<std::size_t>(count);
    if (std::cmp_greater(length, max_bytes)) {
      too_long();
    }
  }
  content.resize(length);
  return content;
}

void write_file(const std::filesystem::path& file, std::string_view content, Durability durability) {
  PendingFile pending(file);
  Descriptor output(::open(pending.temporary().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (output.get() < 0) {
    fail(file, "cannot be written", errno);
  }
  write_all(file, output.get(), content);
  if (durability == Durability::synced && ::fsync(output.get()) != 0) {
    fail(file, "cannot be written", errno);
  }
  if (output.close() != 0) {
    fail(file, "cannot be written", errno);
  }
  pending.commit();
  if (durability == Durability::synced) {
    const std::filesystem::path directory = file.has_parent_path() ? file.parent_path() : ".";
    const Descriptor parent(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (parent.get() < 0 || ::fsync(parent.get()) != 0) {
      fail(file, "cannot be written", errno);
    }
  }
}

void make_directory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (std::error_code ignored; std::filesystem::is_regular_file(directory, ignored)) {
    throw UserError(directory.string() + ": is a file; results need a directory, choose another name");
  }
  if (!error && !std::filesystem::is_directory(directory, error)) {
    error = std::make_error_code(std::errc::not_a_directory);
  }
  if (error) {
    fail(directory, "cannot be made a directory", error.value());
  }
}

PendingFile::PendingFile(std::filesystem::path target)
    : target_(std::move(target)), temporary_(temporary_name(target_)) {
  std::error_code ignored;
  if (!target_.has_filename() || std::filesystem::is_directory(target_, ignored)) {
    fail(target_, "cannot be written", EISDIR);
  }
  const std::lock_guard guard(pending_names().lock);
  pending_names().names.insert(temporary_);
}

PendingFile::~PendingFile() {
  const std::lock_guard guard(pending_names().lock);
  pending_names().names.erase(temporary_);
  if (!committed_) {
    ::unlink(temporary_.c_str());
  }
}

void PendingFile::commit() {
  const std::lock_guard guard(pending_names().lock);
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    fail(target_, "cannot be written", errno);
  }
  committed_ = true;
}

void abandon_pending_files() {
  pending_names().lock.lock();  // for good
  for (const std::filesystem::path& name : pending_names().names) {
    ::unlink(name.c_str());
  }
}

}  // namespace marti::sim
