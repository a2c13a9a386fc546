#include "studies/report/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "sim/error.h"
#include "studies/host/signals_held.h"

namespace marti::studies {

namespace {

using Clock = std::chrono::steady_clock;

std::string reason(int error) { return std::generic_category().message(error); }

/// Two connected ends. A socket and not a pipe, because writing to one that nobody reads any more need not
/// raise a signal.
struct Channel {
  Channel() {
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      throw sim::UserError("no other program can be started: " + reason(errno));
    }
  }
  ~Channel() {
    close(0);
    close(1);
  }
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;
  void close(std::size_t end) {
    if (ends[end] >= 0) {
      ::close(std::exchange(ends[end], -1));
    }
  }
  [[nodiscard]] int ours() const { return ends[0]; }
  [[nodiscard]] int theirs() const { return ends[1]; }

  std::array<int, 2> ends{-1, -1};
};

/// Our environment with `added` before it, so that getenv() finds `added` first.
std::vector<std::string> environment_with(const std::vector<std::string>& added) {
  std::vector<std::string> all = added;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::string_view name = text.substr(0, text.find('=') + 1);
    if (std::none_of(added.begin(), added.end(), [&](const std::string& a) { return a.starts_with(name); })) {
      all.emplace_back(text);
    }
  }
  return all;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) {
    result.push_back(text.data());
  }
  result.push_back(nullptr);
  return result;
}

pid_t start(const ChildProcess& child, const std::array<Channel, 3>& channels) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  for (int number = 0; number < 3; ++number) {
    posix_spawn_file_actions_adddup2(&actions, channels[static_cast<std::size_t>(number)].theirs(), number);
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
    throw sim::UserError(command.front() + " is needed for this and cannot be started: " + reason(error) +
                         " (Debian package: " + child.package + ")");
  }
  return process;
}

/// Kills the process, unless wait_until() has seen its end.
class Running {
 public:
  explicit Running(pid_t process) : process_(process) {}
  ~Running() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  /// Its status as waitpid() gives it, or -1 when it has not ended by then.
  int wait_until(Clock::time_point end) {
    int status = 0;
    while (::waitpid(process_, &status, WNOHANG) == 0) {
      if (Clock::now() >= end) {
        return -1;
      }
      ::poll(nullptr, 0, 1);  // it has closed its output: it is about to end
    }
    process_ = -1;
    return status;
  }

 private:
  pid_t process_;
};

/// Appends what can be read now; false at the end of it.
bool read_more(int from, std::string& to) {
  std::array<char, 65536> buffer{};
  const ssize_t count = ::recv(from, buffer.data(), buffer.size(), 0);
  if (count > 0) {
    to.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return count > 0 || (count < 0 && errno == EINTR);
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
  std::array<Channel, 3> channels;
  const pid_t process = start(child, channels);
  Running running(process);
  const AtSignal with_us([process](int /*signal*/) { ::kill(process, SIGKILL); });
  for (Channel& channel : channels) {
    channel.close(1);
  }
  std::string output;
  std::string errors;
  while (channels[1].ours() >= 0 || channels[2].ours() >= 0) {
    if (input.empty()) {
      channels[0].close(0);
    }
    std::array<pollfd, 3> ready{pollfd{channels[0].ours(), POLLOUT, 0}, pollfd{channels[1].ours(), POLLIN, 0},
                                pollfd{channels[2].ours(), POLLIN, 0}};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    if (left.count() <= 0) {
      break;
    }
    ::poll(ready.data(), ready.size(), static_cast<int>(left.count()));
    if (ready[0].revents != 0) {
      const ssize_t count =
          ::send(channels[0].ours(), input.data(), input.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      // A child that stops reading tells the reason by its exit status.
      input.remove_prefix(count < 0 && errno != EAGAIN && errno != EINTR
                              ? input.size()
                              : static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    }
    if (ready[1].revents != 0 && !read_more(channels[1].ours(), output)) {
      channels[1].close(0);
    }
    if (ready[2].revents != 0 && !read_more(channels[2].ours(), errors)) {
      channels[2].close(0);
    }
    if (output.size() > most || errors.size() > most) {
      throw sim::UserError(name + " wrote more than " + std::to_string(most) + " bytes and was ended");
    }
  }
  const int status = running.wait_until(end);
  if (status == -1) {
    throw sim::UserError(name + " took longer than " + std::to_string(child.limit.count()) +
                         " seconds and was ended");
  }
  if (WIFSIGNALED(status)) {
    throw sim::UserError(name + " was ended by signal " + std::to_string(WTERMSIG(status)));
  }
  if (WEXITSTATUS(status) != 0) {
    throw sim::UserError(name + " failed with status " + std::to_string(WEXITSTATUS(status)) + ": " +
                         last_words(errors));
  }
  return output;
}

}  // namespace marti::studies
