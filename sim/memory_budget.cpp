#include "sim/memory_budget.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "sim/key_error.h"
#include "sim/parse_number.h"
#include "sim/units.h"
#include "sim/work_meter.h"

namespace marti::sim {

namespace {

constexpr std::uint64_t most_bytes = std::numeric_limits<std::int64_t>::max();
constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20U;

// Sizes from a mebibyte on are shown in whole ones: a need rounded up, a limit rounded down.
std::string needed_text(std::uint64_t bytes) {
  bytes = std::min(bytes, most_bytes - mebibyte);
  return print_size(
      static_cast<std::int64_t>(bytes < mebibyte ? bytes : (bytes + mebibyte - 1) / mebibyte * mebibyte));
}

std::string limit_text(std::uint64_t bytes, bool exact) {
  bytes = std::min(bytes, most_bytes);
  return print_size(
      static_cast<std::int64_t>(exact || bytes < mebibyte ? bytes : bytes / mebibyte * mebibyte));
}

// The number that a file begins with; most_bytes if there is no such file or it says "max".
std::uint64_t number_in(const std::filesystem::path& file) {
  std::string text;
  std::ifstream(file) >> text;
  return parse_number<std::uint64_t>(text).value_or(most_bytes);
}

// The least limit of a control group and its ancestors.
std::uint64_t least_limit(const std::filesystem::path& mount, std::filesystem::path group,
                          const std::string& file) {
  std::uint64_t least = number_in(mount / file);
  for (group = group.relative_path(); !group.empty(); group = group.parent_path()) {
    least = std::min(least, number_in(mount / group / file));
  }
  return least;
}

std::uint64_t group_limit(const std::filesystem::path& root) {
  const std::filesystem::path mount = root / "sys/fs/cgroup";
  // In a container the group's own path may not exist; the mount is then the group itself.
  std::uint64_t least =
      std::min(number_in(mount / "memory.max"), number_in(mount / "memory/memory.limit_in_bytes"));
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first == std::string::npos ? first : first + 1);
    if (second == std::string::npos) {
      continue;
    }
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::filesystem::path group = line.substr(second + 1);
    if (controllers == ",,") {
      least = std::min(least, least_limit(mount, group, "memory.max"));
    } else if (controllers.find(",memory,") != std::string::npos) {
      least = std::min(least, least_limit(mount / "memory", group, "memory.limit_in_bytes"));
    }
  }
  return least;
}

// The host's memory, from a line such as "MemTotal:  24683304 kB", in units of 1,024 bytes.
std::uint64_t host_memory(const std::filesystem::path& root) {
  std::ifstream info(root / "proc/meminfo");
  std::string name;
  std::uint64_t kibibytes = 0;
  if (info >> name >> kibibytes && name == "MemTotal:" && kibibytes > 0 && kibibytes < most_bytes / 1024) {
    return kibibytes * 1024;
  }
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
}

}  // namespace

std::string MemoryBudget::needed(std::uint64_t bytes) const {
  std::string text = " about " + needed_text(bytes);
  if (taken_ >= mebibyte) {
    text += " beside " + needed_text(taken_) + " that are taken";
  }
  return text;
}

std::string MemoryBudget::limit_and_source() const {
  return limit_text(limit_, given_) +
         (given_ ? "" : " (three quarters of what the host lets this process have)");
}

std::string MemoryBudget::excess(std::uint64_t bytes) const {
  if (bytes <= left()) {
    return {};
  }
  return needed(bytes) + ", more than " + std::string(memory_limit_key) + " = " + limit_and_source();
}

void MemoryBudget::end_if_stopped() const { sim::end_if_stopped(meter_); }

void MemoryBudget::require(std::uint64_t bytes, std::string_view what, std::string_view remedy) const {
  end_if_stopped();
  if (bytes > left()) {
    throw KeyError(std::string(memory_limit_key), std::string(what) + needed(bytes) + ", more than " +
                                                      limit_and_source() + ": raise the limit" +
                                                      (remedy.empty() ? "" : ", or " + std::string(remedy)));
  }
}

void MemoryBudget::take(std::uint64_t bytes, std::string_view what, std::string_view remedy) {
  require(bytes, what, remedy);
  taken_ += bytes;
}

std::uint64_t usable_memory(const std::filesystem::path& root) {
  std::uint64_t least = std::min(host_memory(root), group_limit(root));
  rlimit space{};
  if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) {
    least = std::min<std::uint64_t>(least, space.rlim_cur);
  }
  return least;
}

std::uint64_t default_memory_limit(std::uint64_t processes) {
  static const std::uint64_t usable = usable_memory();  // a sweep asks at each of its points
  return usable / 4 * 3 / std::max<std::uint64_t>(1, processes);
}

}  // namespace marti::sim
