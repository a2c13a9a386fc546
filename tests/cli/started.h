// The program running beside the test, to be sent signals.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

namespace marti::test {

class Started {
 public:
  /// Runs the program with these arguments. What it prints goes to the file `output`, and its standard error
  /// to the descriptor `errors` if there is one, else to the file too.
  Started(std::vector<std::string> arguments, const std::filesystem::path& output,
          int errors = STDOUT_FILENO) {
    arguments.insert(arguments.begin(), MARTI_PROGRAM);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) {
      pointers.push_back(argument.data());
    }
    pointers.push_back(nullptr);
    process_ = fork();
    if (process_ == 0) {
      // A shell may have had the test ignore it.
      std::signal(SIGINT, SIG_DFL);
      const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
      dup2(file, STDOUT_FILENO);
      dup2(errors, STDERR_FILENO);
      execv(pointers[0], pointers.data());
      _exit(127);
    }
  }
  ~Started() {
    if (!ended()) {
      ::kill(process_, SIGKILL);
      (void)wait();
    }
  }
  Started(const Started&) = delete;
  Started& operator=(const Started&) = delete;

  void send(int signal) const { ::kill(process_, signal); }
  [[nodiscard]] bool ended() {
    if (!waited_ && waitpid(process_, &status_, WNOHANG) == process_) {
      waited_ = true;
    }
    return waited_;
  }
  /// Its exit status, or minus the signal that killed it.
  int wait() {
    if (!waited_) {
      waitpid(process_, &status_, 0);
      waited_ = true;
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  }

 private:
  pid_t process_ = -1;
  int status_ = 0;
  bool waited_ = false;
};

}  // namespace marti::test
