#include "processors/path/path_sum.h"

#include <algorithm>

namespace marti::processors::path {

void PathSum::join(const PathPiece& last) {
  if (pieces_ == 0) {
    last_ = last;
    return;
  }
  pieces_ -= first_.goes_on_from(last) ? 1 : 0;
  node_changes_ += first_.owner.node == last.owner.node ? 0 : 1;
}

sim::Ticks& PathSum::time_of(std::uint32_t node) {
  const auto at =
      std::lower_bound(nodes_.begin(), nodes_.end(), node,
                       [](const auto& entry, std::uint32_t number) { return entry.first < number; });
  return (at != nodes_.end() && at->first == node ? at : nodes_.insert(at, {node, 0}))->second;
}

PathLevel& PathSum::level_of(std::uint32_t level) {
  if (levels_.size() < level) {
    levels_.resize(level);
  }
  return levels_[level - 1];
}

void PathSum::prepend(const PathPiece& piece, LogLevels& levels) {
  join(piece);
  first_ = piece;
  ++pieces_;
  const sim::Ticks length = piece.to - piece.from;
  time_[static_cast<std::size_t>(piece.kind)] += length;
  time_of(piece.owner.node) += length;
  if (piece.kind == PathKind::traversal) {
    levels.divide(piece.owner.place, length, [&](std::uint32_t level, sim::Ticks ticks) {
      if (level != 0) {
        level_of(level).traversal += ticks;
      }
    });
  } else if (!is_own_work(piece.kind) && piece.kind != PathKind::dispatch) {
    if (const std::uint32_t level = levels.level_at(piece.owner.place); level != 0) {
      level_of(level).reads += length;
    }
  }
}

void PathSum::prepend(const PathSum& before) {
  join(before.last_);
  first_ = before.first_;
  pieces_ += before.pieces_;
  node_changes_ += before.node_changes_;
  for (std::size_t kind = 0; kind < path_kinds; ++kind) {
    time_[kind] += before.time_[kind];
  }
  for (const auto& [node, time] : before.nodes_) {
    time_of(node) += time;
  }
  for (std::uint32_t level = 1; level <= before.levels_.size(); ++level) {
    level_of(level).traversal += before.levels_[level - 1].traversal;
    level_of(level).reads += before.levels_[level - 1].reads;
  }
}

}  // namespace marti::processors::path
