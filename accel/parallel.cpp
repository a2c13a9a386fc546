#include "accel/parallel.h"

#include <algorithm>
#include <optional>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

namespace marti::accel {

void parallel_pieces(std::size_t count, std::size_t grain, unsigned threads,
                     const std::function<void(std::size_t begin, std::size_t end)>& body) {
  const std::size_t pieces = (count + grain - 1) / grain;
  const auto here = static_cast<unsigned>(tbb::info::default_concurrency());
  if (pieces <= 1 || threads == 1 || (threads == 0 && here == 1)) {
    if (count > 0) {
      body(0, count);
    }
    return;
  }
  // Tests of determinism ask for more threads than cores; TBB grants them only through this control.
  std::optional<tbb::global_control> more_threads;
  if (threads > here) {
    more_threads.emplace(tbb::global_control::max_allowed_parallelism, threads);
  }
  tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads));
  arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, pieces,
        [&](std::size_t piece) { body(piece * grain, std::min(count, (piece + 1) * grain)); },
        tbb::simple_partitioner());
  });
}

}  // namespace marti::accel
