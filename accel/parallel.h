// Parallel loops on a given number of host threads.
#pragma once

#include <cstddef>
#include <functional>

namespace marti::accel {

/// Calls `body(begin, end)` for pieces of [0, count), on up to `threads` host threads (0: all); each piece
/// except the last has `grain` elements. Called once, on this thread, when there is one piece or one thread.
/// Pieces must not depend on one another.
void parallel_pieces(std::size_t count, std::size_t grain, unsigned threads,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace marti::accel
