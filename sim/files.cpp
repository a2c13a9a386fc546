#include "sim/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "sim/descriptor.h"
#include "sim/error.h"
#include "sim/units.h"

namespace marti::sim {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, std::string_view what, int error) {
  throw UserError(Place{file.string(), file.string()},
                  std::string(what) + ": " + std::generic_category().message(error));
}

}  // namespace

std::string read_file(const std::filesystem::path& file, std::int64_t max_bytes) {
  // O_NONBLOCK: opening a pipe without a writer must not wait for ever; it is refused below.
  const Descriptor input(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
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
  // Reading one byte more than expected finds the end, also of files in /proc, which state no size.
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
  pending.write(content, durability);
  pending.commit();
  if (durability == Durability::synced) {
    const std::filesystem::path directory = file.has_parent_path() ? file.parent_path() : ".";
    const Descriptor parent(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (parent.get() < 0 || ::fsync(parent.get()) != 0) {
      fail(file, "cannot be written", errno);
    }
  }
}

}  // namespace marti::sim
