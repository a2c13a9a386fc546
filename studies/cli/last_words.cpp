// What the program says when an exception meets nobody who could catch it: libraries start threads while they
// are loaded, before main() (OpenImageIO brings log4cplus, which does), and inside of functions that must not
// throw.
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

namespace {

[[noreturn]] void end_with(std::string_view message) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, message.data(), message.size());
  _exit(2);  // as for any wrong input
}

std::terminate_handler usual = nullptr;

[[noreturn]] void say_why() {
  if (const std::exception_ptr error = std::current_exception()) {
    try {
      std::rethrow_exception(error);
    } catch (const std::system_error& refused) {
      if (refused.code().value() == EAGAIN) {
        end_with("marti: the system lets this process have no more threads\n");
      }
    } catch (const std::bad_alloc&) {
      end_with("marti: not enough memory\n");
    } catch (...) {
      // Any other exception is a fault of the program, which the usual handler reports.
    }
  }
  usual();
  std::abort();
}

// Functions of .preinit_array run before the constructors of shared libraries (System V ABI, "Initialization
// and Termination Functions").
using Function = void (*)();
[[gnu::used, gnu::section(".preinit_array")]] const Function before_all_libraries = [] {
  usual = std::set_terminate(say_why);
};

}  // namespace
