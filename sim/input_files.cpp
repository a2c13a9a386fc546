#include "sim/input_files.h"

#include <sys/stat.h>

#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "sim/error.h"
#include "sim/sha256.h"
#include "sim/shown.h"

namespace marti::sim {

namespace {

using Identity = std::pair<dev_t, ino_t>;

struct Inputs {
  std::mutex mutex;
  std::map<Identity, std::filesystem::path> files;
};

// Never destroyed: the program may end while another thread uses it.
Inputs& inputs() {
  static auto& all = *new Inputs;  // NOLINT(cppcoreguidelines-owning-memory)
  return all;
}

std::optional<Identity> identity_of(const std::filesystem::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? std::optional(Identity(status.st_dev, status.st_ino))
                                            : std::nullopt;
}

}  // namespace

void note_input(const std::filesystem::path& file) {
  if (const std::optional<Identity> identity = identity_of(file)) {
    std::error_code failed;
    const std::filesystem::path place = std::filesystem::absolute(file, failed);
    const std::lock_guard guard(inputs().mutex);
    inputs().files.insert_or_assign(*identity, failed ? file : place);
  }
}

std::string inputs_digest() {
  std::string text;
  const std::lock_guard guard(inputs().mutex);
  for (const auto& [identity, file] : inputs().files) {
    struct stat status {};
    const bool there = ::stat(file.c_str(), &status) == 0;
    text += file.string() + "\n" +
            (there ? std::to_string(status.st_size) + " " + std::to_string(status.st_mtim.tv_sec) + "." +
                         std::to_string(status.st_mtim.tv_nsec)
                   : std::string("gone")) +
            "\n";
  }
  return sha256_text(text);
}

void refuse_input(const std::filesystem::path& target) {
  const std::optional<Identity> identity = identity_of(target);
  if (!identity) {
    return;
  }
  std::filesystem::path input;
  {
    const std::lock_guard guard(inputs().mutex);
    const auto found = inputs().files.find(*identity);
    if (found == inputs().files.end()) {
      return;
    }
    input = found->second;
  }
  // The number of a file that was deleted may have been given to another one.
  if (identity_of(input) == identity) {
    throw UserError(
        shown(target.string()) +
        ": is read as input and would be replaced by a result; write to another directory or name");
  }
}

}  // namespace marti::sim
