#include "studies/host/host_threads.h"

#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <latch>
#include <memory>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace marti::studies::host {

namespace {

// Threads outside the pools: the main one, and one that waits for signals.
constexpr std::size_t others = 2;

// How many of `wanted` threads can exist at the same time, found by starting them.
std::size_t started_at_once(std::size_t wanted) {
  std::latch over(1);
  std::vector<std::jthread> threads;
  threads.reserve(wanted);
  try {
    while (threads.size() < wanted) {
      threads.emplace_back([&over] { over.wait(); });
    }
  } catch (const std::system_error&) {
  } catch (const std::bad_alloc&) {
  }
  over.count_down();
  return threads.size();
}

// oneTBB starts its threads late, and other memory may have taken the address space by then: start them now.
void start_pool(std::size_t threads) {
  rlimit space{};
  if (threads < 2 || getrlimit(RLIMIT_AS, &space) != 0 || space.rlim_cur == RLIM_INFINITY) {
    return;
  }
  const auto longest = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
  std::atomic<std::size_t> here = 0;
  tbb::task_arena arena(static_cast<int>(threads));
  arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, threads,
        [&](std::size_t) {
          for (++here; here < threads && std::chrono::steady_clock::now() < longest;) {
            std::this_thread::yield();
          }
        },
        tbb::simple_partitioner());
  });
}

}  // namespace

void limit_threads_to_available() {
  const auto processors = static_cast<std::size_t>(std::max(1, tbb::info::default_concurrency()));
  const std::size_t wanted = 2 * processors + others;
  const std::size_t there = started_at_once(wanted);
  std::size_t threads = processors;
  if (there < wanted) {
    threads = there < others + 2 ? 1 : (there - others) / 2;
    // Never destroyed: at the program's end its destructor would start the threads that there are not.
    static const auto* const limit =
        new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads);
    static_cast<void>(limit);
  }
  start_pool(threads);
}

}  // namespace marti::studies::host
