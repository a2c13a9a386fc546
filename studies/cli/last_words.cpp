// What the program says when an exception meets nobody who could catch it: libraries start threads inside of
// functions that must not throw, and while they are loaded (log4cplus, which studies/host/image_file.cpp
// loads with OpenImageIO).
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

[[noreturn]] void say_why();

// Set before main() begins.
const std::terminate_handler usual = std::set_terminate(say_why);

void say_why() {
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

}  // namespace
