#include "processors/path/critical_path.h"

#include <numeric>

#include "sim/error.h"

namespace marti::processors::path {

CriticalPath add_up(const PathPieces& pieces, const PathTip& tip, std::uint32_t nodes, LogLevels& levels) {
  const PathSum sum = pieces.sum_of(tip, levels);
  CriticalPath path;
  path.end = tip.end();
  path.time = sum.time();
  path.nodes.resize(nodes);
  for (const auto& [node, time] : sum.nodes()) {
    path.nodes[node] = time;
  }
  path.levels = sum.levels();
  path.pieces = sum.pieces();
  path.node_changes = sum.node_changes();
  sim::ensure(std::reduce(path.time.begin(), path.time.end()) == path.end &&
                  std::reduce(path.nodes.begin(), path.nodes.end()) == path.end,
              "the pieces of a critical path do not add up to the frame time");
  return path;
}

}  // namespace marti::processors::path
