#include "sim/finished_parts.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <utility>

#include "sim/error.h"
#include "sim/files.h"
#include "sim/sha256.h"
#include "sim/shown.h"

namespace marti::sim {

namespace {

constexpr std::string_view head = "parts of a study of marti that is not finished\n";

/// What stands before a part's name and bytes.
struct PartHead {
  std::uint64_t name = 0;  ///< bytes of each
  std::uint64_t bytes = 0;
  std::array<std::uint8_t, 32> hash{};  ///< of both together
};

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw UserError(shown(file.string()) + ": " + what);
}

}  // namespace

FinishedParts::FinishedParts(std::filesystem::path file, const std::string& work)
    : file_(std::move(file)), open_(::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666)) {
  if (open_.get() < 0) {
    fail(file_, std::string("cannot be written: ") + std::strerror(errno));
  }
  if (::flock(open_.get(), LOCK_EX | LOCK_NB) != 0) {
    fail(file_, "is in use: another process runs a study into this directory");
  }
  const std::string content = read_file(file_, std::numeric_limits<std::int64_t>::max());
  if (!content.starts_with(head) && !head.starts_with(content)) {
    fail(file_,
         "is not of marti, which would keep the finished parts of a study there; give another directory");
  }
  const std::string begin = std::string(head) + sha256_text(work) + "\n";
  std::size_t whole = 0;
  if (content.starts_with(begin)) {
    whole = begin.size() + read(std::string_view(content).substr(begin.size()));
  }
  if (::ftruncate(open_.get(), static_cast<off_t>(whole)) != 0 || ::lseek(open_.get(), 0, SEEK_END) < 0) {
    fail(file_, std::string("cannot be written: ") + std::strerror(errno));
  }
  if (whole == 0) {
    try {
      write(begin);
    } catch (const UserError&) {
      static_cast<void>(::unlink(file_.c_str()));
      throw;
    }
  }
  taken_up_ = parts_.size();
}

FinishedParts::~FinishedParts() { static_cast<void>(::unlink(file_.c_str())); }

std::size_t FinishedParts::read(std::string_view content) {
  std::size_t whole = 0;
  PartHead part;
  for (std::string_view rest = content;
       unpack(rest, part) && part.name <= rest.size() && part.bytes <= rest.size() - part.name;) {
    const std::string_view both = rest.substr(0, part.name + part.bytes);
    if (sha256(both) != part.hash) {
      break;
    }
    parts_.insert_or_assign(std::string(both.substr(0, part.name)), std::string(both.substr(part.name)));
    whole += sizeof part + both.size();
    rest.remove_prefix(both.size());
  }
  return whole;
}

std::optional<std::string> FinishedParts::find(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = parts_.find(name);
  return found == parts_.end() ? std::nullopt : std::optional(found->second);
}

void FinishedParts::keep(const std::string& name, const std::string& bytes) {
  const std::lock_guard lock(mutex_);
  const std::string both = name + bytes;
  std::string record;
  pack(record, PartHead{name.size(), bytes.size(), sha256(both)});
  write(record + both);
  parts_.insert_or_assign(name, bytes);
}

void FinishedParts::write(std::string_view bytes) {
  if (const int error = write_all(open_.get(), bytes); error != 0) {
    fail(file_, std::string("cannot be written: ") + std::strerror(error));
  }
}

}  // namespace marti::sim
