// The program with a terminal as its standard error.
#pragma once

#include <fcntl.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/cli/started.h"
#include "tests/support/screen.h"

namespace marti::test {

class OnTerminal {
 public:
  /// Runs the program with these arguments; what it prints goes to the file `output`.
  OnTerminal(std::vector<std::string> arguments, const std::filesystem::path& output)
      : program_(std::move(arguments), output, open_terminal()) {
    close(slave_);
  }
  ~OnTerminal() { close(terminal_); }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  /// Reads until the program has written this text to its terminal, or has ended. Whether it has.
  bool wait_for(const std::string& text) {
    while (written_.find(text) == std::string::npos) {
      if (!read_some()) {
        return false;
      }
    }
    return true;
  }
  /// Sends the signal, 0 for none, and waits for the end; its exit status, or minus the signal that killed
  /// it.
  int end_by(int signal) {
    program_.send(signal);
    while (read_some()) {
    }
    return program_.wait();
  }
  [[nodiscard]] std::string screen() const { return screen_after(written_); }

 private:
  // The program's end of a new terminal.
  int open_terminal() {
    if (openpty(&terminal_, &slave_, nullptr, nullptr, nullptr) == 0) {
      fcntl(terminal_, F_SETFD, FD_CLOEXEC);
    }
    return slave_;
  }
  // False at the end of the program.
  bool read_some() {
    std::array<char, 4096> part{};
    const ssize_t size = ::read(terminal_, part.data(), part.size());
    if (size > 0) {
      written_.append(part.data(), static_cast<std::size_t>(size));
    }
    return size > 0;
  }

  int terminal_ = -1;
  int slave_ = -1;
  Started program_;
  std::string written_;
};

}  // namespace marti::test
