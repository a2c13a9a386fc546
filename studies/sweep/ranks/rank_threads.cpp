#include <sched.h>
#include <unistd.h>

#include <algorithm>

#include "studies/sweep/ranks/ranks.h"

namespace marti::studies::sweep {

unsigned threads_of_rank(const Ranks& ranks) {
  cpu_set_t set;
  CPU_ZERO(&set);
  const long online = std::max(1L, sysconf(_SC_NPROCESSORS_ONLN));
  if (sched_getaffinity(0, sizeof set, &set) != 0) {
    CPU_SET(0, &set);
  }
  const auto mine = static_cast<std::size_t>(std::max(1, CPU_COUNT(&set)));
  const bool bound = mine < static_cast<std::size_t>(online);
  return static_cast<unsigned>(std::max<std::size_t>(1, bound ? mine : mine / ranks.on_this_computer()));
}

}  // namespace marti::studies::sweep
