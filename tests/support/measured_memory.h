// How much memory a piece of work takes, measured from outside of it.
#pragma once

#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>

namespace marti::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool memory_can_be_measured = false;  // the sanitizer's own memory is far larger
#else
inline constexpr bool memory_can_be_measured = true;
#endif

// A line of /proc/self/status, in bytes.
inline std::uint64_t own_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name + ":")) {
      return std::strtoull(line.c_str() + name.size() + 1, nullptr, 10) * 1024;
    }
  }
  return 0;
}

/// The most resident bytes at a time that `work` adds, in a process of its own, which ends with it: `work`
/// must not throw. The calling process must not have started threads that `work` needs (oneTBB's).
inline std::uint64_t peak_bytes(const std::function<void()>& work) {
  int ends[2] = {-1, -1};
  if (pipe(ends) != 0) {
    return 0;
  }
  const pid_t child = fork();
  if (child == 0) {
    malloc_trim(0);  // memory that earlier work has freed must not hide what this work takes
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins anew (proc(5))
    const std::uint64_t before = own_bytes("VmRSS");
    work();
    const std::uint64_t peak = own_bytes("VmHWM") - before;
    const bool told = write(ends[1], &peak, sizeof peak) == static_cast<ssize_t>(sizeof peak);
    _exit(told ? 0 : 1);
  }
  std::uint64_t peak = 0;
  close(ends[1]);
  const bool heard = read(ends[0], &peak, sizeof peak) == static_cast<ssize_t>(sizeof peak);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return heard && status == 0 ? peak : 0;
}

}  // namespace marti::test
