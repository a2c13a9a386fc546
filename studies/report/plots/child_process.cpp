#include "studies/report/plots/child_process.h"

#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/host/signals_held.h"

namespace marti::studies::report {

namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void cannot_start(int error) {
  throw sim::UserError("no other program can be started: " + std::generic_category().message(error));
}

/// A file in memory, of which the child has another descriptor. It can neither fill up nor be closed by the
/// one that reads it, so neither of the two programs can block on the other.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content = {}) : descriptor_(::memfd_create("marti", MFD_CLOEXEC)) {
    if (descriptor_ < 0) {
      cannot_start(errno);
    }
    for (off_t at = 0; !content.empty();) {
      const ssize_t count = ::pwrite(descriptor_, content.data(), content.size(), at);
      if (count <= 0) {
        cannot_start(errno);
      }
      content.remove_prefix(static_cast<std::size_t>(count));
      at += count;
    }
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] std::size_t size() const {
    struct stat status {};
    return ::fstat(descriptor_, &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
  }
  [[nodiscard]] std::string content() const {
    std::string text(size(), '\0');
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t count = ::pread(descriptor_, &text[at], text.size() - at, static_cast<off_t>(at));
      if (count <= 0) {
        throw sim::UserError("the output of another program cannot be read: " +
                             std::generic_category().message(errno));
      }
      at += static_cast<std::size_t>(count);
    }
    return text;
  }

 private:
  int descriptor_;
};

/// Our environment with `added` before it, so that getenv() finds `added` first.
std::vector<std::string> environment_with(const std::vector<std::string>& added) {
  std::vector<std::string> all = added;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::string_view name = text.substr(0, text.find('=') + 1);
    if (std::ranges::none_of(added, [&](const std::string& a) { return a.starts_with(name); })) {
      all.emplace_back(text);
    }
  }
  return all;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result = sim::mapped(texts, [&](std::string& text) { return text.data(); });
  result.push_back(nullptr);
  return result;
}

/// `files` become its standard input, output and error output.
pid_t start(const ChildProcess& child, const std::array<MemoryFile, 3>& files) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  for (int number = 0; number < 3; ++number) {
    posix_spawn_file_actions_adddup2(&actions, files[static_cast<std::size_t>(number)].descriptor(), number);
  }
  // A child inherits our signal mask, which blocks the signals that one thread waits for: unblock them.
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  std::vector<std::string> command = child.command;
  std::vector<std::string> environment = environment_with(child.environment);
  pid_t process = -1;
  const int error = posix_spawnp(&process, command.front().c_str(), &actions, &attributes,
                                 pointers(command).data(), pointers(environment).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw sim::UserError(command.front() + " is needed for this and cannot be started: " +
                         std::generic_category().message(error) + " (Debian package: " + child.package + ")");
  }
  return process;
}

/// The last lines, which say most when a program fails.
std::string last_words(const std::string& text) {
  constexpr std::size_t most = 2000;
  std::string words = text.size() > most ? "... " + text.substr(text.size() - most) : text;
  while (!words.empty() && (words.back() == '\n' || words.back() == '\r')) {
    words.pop_back();
  }
  return words.empty() ? "it says nothing" : words;
}

}  // namespace

std::string run_child(const ChildProcess& child, std::string_view input, std::size_t most) {
  const std::string& name = child.command.front();
  const Clock::time_point end = Clock::now() + child.limit;
  const std::array<MemoryFile, 3> files{MemoryFile(input), MemoryFile(), MemoryFile()};
  const pid_t process = start(child, files);
  const host::AtSignal kill_child_at_signal([process](int /*signal*/) { ::kill(process, SIGKILL); });
  int status = 0;
  std::string fault;
  for (;;) {
    const pid_t ended = ::waitpid(process, &status, fault.empty() ? WNOHANG : 0);
    if (ended == process) {
      break;
    }
    if (ended < 0 && errno != EINTR) {
      throw sim::UserError(name +
                           ": its end cannot be waited for: " + std::generic_category().message(errno));
    }
    if (files[1].size() > most || files[2].size() > most) {
      fault = " wrote more than " + std::to_string(most) + " bytes and was ended";
    } else if (Clock::now() >= end) {
      fault = " took longer than " + std::to_string(child.limit.count()) + " seconds and was ended";
    }
    if (fault.empty()) {
      ::poll(nullptr, 0, 1);
    } else {
      ::kill(process, SIGKILL);
    }
  }
  if (fault.empty() && WIFSIGNALED(status)) {
    fault = " was ended by signal " + std::to_string(WTERMSIG(status));
  } else if (fault.empty() && WEXITSTATUS(status) != 0) {
    fault =
        " failed with status " + std::to_string(WEXITSTATUS(status)) + ": " + last_words(files[2].content());
  }
  if (!fault.empty()) {
    throw sim::UserError(name + fault);
  }
  return files[1].content();
}

}  // namespace marti::studies::report
