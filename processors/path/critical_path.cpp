#include "processors/path/critical_path.h"

#include <numeric>
#include <optional>

#include "sim/error.h"

namespace marti::processors {

namespace {

CriticalPath::Level& level_of(CriticalPath& path, std::uint32_t level) {
  if (path.levels.size() < level) {
    path.levels.resize(level);
  }
  return path.levels[level - 1];
}

void add_levels(CriticalPath& path, const PathPiece& piece, LogLevels& levels) {
  const sim::Ticks length = piece.to - piece.from;
  if (piece.kind == PathKind::traversal) {
    levels.divide(piece.owner.place, length, [&](std::uint32_t level, sim::Ticks ticks) {
      if (level != 0) {
        level_of(path, level).traversal += ticks;
      }
    });
  } else if (!is_own_work(piece.kind) && piece.kind != PathKind::dispatch) {
    if (const std::uint32_t level = levels.level_at(piece.owner.place); level != 0) {
      level_of(path, level).reads += length;
    }
  }
}

}  // namespace

CriticalPath add_up(const PathPieces& pieces, const PathTip& tip, std::uint32_t nodes, LogLevels& levels) {
  CriticalPath path;
  path.end = tip.end();
  path.nodes.resize(nodes);
  sim::Ticks at = tip.end();
  std::optional<PathPiece> after;
  pieces.each_from_the_end(tip, [&](const PathPiece& piece) {
    sim::ensure(piece.to == at && piece.from < piece.to, "a critical path has a gap");
    at = piece.from;
    path.time[static_cast<std::size_t>(piece.kind)] += piece.to - piece.from;
    path.nodes[piece.owner.node] += piece.to - piece.from;
    add_levels(path, piece, levels);
    path.node_changes += after && after->owner.node != piece.owner.node ? 1 : 0;
    path.pieces += after && after->goes_on_from(piece) ? 0 : 1;
    after = piece;
  });
  sim::ensure(at == 0 && std::reduce(path.time.begin(), path.time.end()) == path.end,
              "the pieces of a critical path do not add up to the frame time");
  return path;
}

}  // namespace marti::processors
