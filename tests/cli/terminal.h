// The program with a terminal as its standard error.
#pragma once

#include <fcntl.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

namespace marti::test {

class OnTerminal {
 public:
  /// Runs the program with these arguments; what it prints goes to the file `output`.
  OnTerminal(std::vector<std::string> arguments, const std::filesystem::path& output) {
    arguments.insert(arguments.begin(), MARTI_PROGRAM);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) {
      pointers.push_back(argument.data());
    }
    pointers.push_back(nullptr);
    int slave = -1;
    if (openpty(&terminal_, &slave, nullptr, nullptr, nullptr) != 0) {
      return;
    }
    process_ = fork();
    if (process_ == 0) {
      std::signal(SIGINT, SIG_DFL);
      dup2(open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), STDOUT_FILENO);
      dup2(slave, STDERR_FILENO);
      close(terminal_);
      execv(pointers[0], pointers.data());
      _exit(127);
    }
    close(slave);
  }
  ~OnTerminal() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
    close(terminal_);
  }
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
    ::kill(process_, signal);
    while (read_some()) {
    }
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  /// The lines that the terminal shows.
  [[nodiscard]] std::string screen() const {
    std::string screen;
    std::string line;
    std::size_t at = 0;
    for (const char c : written_) {
      if (c == '\r') {
        at = 0;
      } else if (c == '\n') {
        screen += line + "\n";
        line.clear();
        at = 0;
      } else {
        line.resize(std::max(line.size(), at + 1), ' ');
        line[at++] = c;
      }
    }
    line.erase(line.find_last_not_of(' ') + 1);
    return screen + line;
  }

 private:
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
  pid_t process_ = -1;
  std::string written_;
};

}  // namespace marti::test
