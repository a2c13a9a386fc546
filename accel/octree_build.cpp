#include "accel/octree_build.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include "accel/build_memory.h"
#include "accel/parallel.h"
#include "sim/error.h"

namespace marti::accel {

namespace {

constexpr std::uint32_t deepest_level = 21;
// Triangles in a piece of work; a node with more of them is sorted by several threads.
constexpr std::size_t piece_entries = 2048;
// Pieces that a thread takes at a time, because there are many small nodes.
constexpr std::size_t pieces_at_once = 16;

/// Each level is made from the one before in three steps: its nodes' triangles are sorted, in parallel; which
/// nodes are split is decided in the order of the nodes, because it depends on how much the tree lists so
/// far; the children's lists are written, in parallel.
class OctreeBuilder {
 public:
  OctreeBuilder(const TriangleSet& triangles, const OctreeOptions& options, const RootFrame& frame,
                const BuildLimit& limit, OctreeBuild& out)
      : triangles_(triangles), options_(options), frame_(frame), limit_(limit), out_(out) {}

  void run() {
    level_.cells.push_back({});
    level_.begin = {0, triangles_.size()};
    level_.lists.resize(triangles_.size());
    for (std::uint32_t id = 0; id < triangles_.size(); ++id) {
      level_.lists[id] = id;
    }
    out_.topology.nodes.emplace_back();
    out_.topology.work.emplace_back();
    while (!level_.cells.empty()) {
      if (may_split()) {
        make_pieces();
        sort_pieces();
      }
      decide();
      scatter();
      std::swap(level_, next_);
    }
  }

 private:
  struct Level {
    std::uint32_t number = 1;
    std::uint32_t first_node = 0;
    std::vector<std::array<std::uint32_t, 3>> cells;
    std::vector<std::size_t> begin{0};  ///< first entry of each cell in lists, and the end
    std::vector<std::uint32_t> lists;
  };

  /// Consecutive entries of one node.
  struct Piece {
    std::size_t node;  ///< number in the level
    std::size_t begin;
    std::size_t end;
    std::array<std::uint32_t, 8> count;  ///< how many go to each child
    std::uint32_t overlaps;
    bool split;
    std::array<std::size_t, 8> to;  ///< where they go in the next level's lists
  };

  [[nodiscard]] std::size_t count_of(std::size_t node) const {
    return level_.begin[node + 1] - level_.begin[node];
  }
  [[nodiscard]] bool is_full(std::size_t node) const { return count_of(node) > options_.max_objects; }

  /// Whether any node of the present level can be split.
  [[nodiscard]] bool may_split() {
    pieces_.clear();
    if (!level_splits(frame_, options_.max_level, level_.number)) {
      return false;
    }
    if (limit_.level == level_.number || stops_by_ratio()) {
      for (std::size_t node = 0; node < level_.cells.size(); ++node) {
        if (is_full(node)) {
          out_.unsplit.push_back(level_.first_node + static_cast<std::uint32_t>(node));
        }
      }
      return false;
    }
    return true;
  }

  [[nodiscard]] bool stops_by_ratio() const {
    if (!(limit_.k > 0.0)) {
      return false;
    }
    std::size_t full = 0;
    for (std::size_t node = 0; node < level_.cells.size(); ++node) {
      full += is_full(node) ? 1U : 0U;
    }
    return static_cast<double>(level_.cells.size() - full) > limit_.k * static_cast<double>(full);
  }

  void make_pieces() {
    // No node will be split then, so none need be sorted.
    if (out_.topology.entries.size() + level_.lists.size() >= options_.max_entries ||
        out_.topology.nodes.size() >= most_octree_nodes) {
      for (std::size_t node = 0; node < level_.cells.size(); ++node) {
        out_.cut = out_.cut || is_full(node);
      }
      return;
    }
    std::size_t pieces = 0;
    for (std::size_t node = 0; node < level_.cells.size(); ++node) {
      pieces += is_full(node) ? (count_of(node) + piece_entries - 1) / piece_entries : 0;
    }
    require_memory(0, pieces * sizeof(Piece) + level_.lists.size());
    pieces_.reserve(pieces);
    for (std::size_t node = 0; node < level_.cells.size(); ++node) {
      if (is_full(node)) {
        for (std::size_t at = level_.begin[node]; at < level_.begin[node + 1]; at += piece_entries) {
          pieces_.push_back(
              {node, at, std::min(at + piece_entries, level_.begin[node + 1]), {}, 0, false, {}});
        }
      }
    }
    children_.resize(level_.lists.size());
  }

  void sort_pieces() {
    parallel_pieces(pieces_.size(), pieces_at_once, options_.threads,
                    [this](std::size_t begin, std::size_t end) {
                      options_.memory.end_if_stopped();
                      for (std::size_t p = begin; p < end; ++p) {
                        Piece& piece = pieces_[p];
                        const ChildSorter<double> sorter(frame_, {level_.number, level_.cells[piece.node]});
                        for (std::size_t at = piece.begin; at < piece.end; ++at) {
                          std::uint32_t met = sorter.children(triangles_, level_.lists[at], piece.overlaps);
                          children_[at] = static_cast<std::uint8_t>(met);
                          for (; met != 0; met &= met - 1) {
                            ++piece.count[static_cast<std::size_t>(std::countr_zero(met))];
                          }
                        }
                      }
                    });
  }

  /// In the order of the nodes: writes leaves, and gives branches the numbers and places of their children.
  void decide() {
    next_.number = level_.number + 1;
    next_.first_node = static_cast<std::uint32_t>(out_.topology.nodes.size());
    next_.cells.clear();
    next_.begin.assign(1, 0);
    LevelStatistics& statistics = out_.levels.emplace_back();
    std::size_t piece = 0;
    for (std::size_t node = 0; node < level_.cells.size(); ++node) {
      if (node % nodes_between_checks == 0) {
        require_memory(node, 0);
      }
      const std::size_t first_piece = piece;
      std::array<std::uint32_t, 8> count{};
      SplitWork work{static_cast<std::uint32_t>(count_of(node)), 0};
      for (; piece < pieces_.size() && pieces_[piece].node == node; ++piece) {
        for (std::size_t child = 0; child < 8; ++child) {
          count[child] += pieces_[piece].count[child];
        }
        work.overlaps += pieces_[piece].overlaps;
      }
      const bool sorted = piece != first_piece;
      const std::uint64_t listed =
          out_.topology.entries.size() + next_.begin.back() + (level_.lists.size() - level_.begin[node]);
      const bool room = listed < options_.max_entries && out_.topology.nodes.size() < most_octree_nodes;
      out_.cut = out_.cut || (sorted && !room);
      if (sorted && room && !separates_nothing(count, count_of(node))) {
        make_branch(node, work, count, std::span(pieces_).subspan(first_piece, piece - first_piece));
        ++statistics.branches;
      } else {
        make_leaf(node, statistics);
      }
    }
  }

  /// Checks the memory for the level's nodes from `node` up to the next check, and for `more` bytes.
  void require_memory(std::size_t node, std::uint64_t more) const {
    const std::size_t end = std::min(node + nodes_between_checks, level_.cells.size());
    const std::size_t children = 8 * (end - node);
    const Topology& topology = out_.topology;
    require_tree(options_.memory,
                 growing_bytes(topology.nodes, children) + growing_bytes(topology.work, children) +
                     growing_bytes(topology.entries, level_.begin[end] - level_.begin[node]) +
                     growing_bytes(next_.cells, children) + growing_bytes(next_.begin, children) +
                     bytes_of_vector(next_.lists) + next_.begin.back() * sizeof(std::uint32_t) +
                     bytes_of_vector(level_.cells) + bytes_of_vector(level_.begin) +
                     bytes_of_vector(level_.lists) + bytes_of_vector(pieces_) + bytes_of_vector(children_) +
                     more,
                 "octree");
  }

  void make_branch(std::size_t node, const SplitWork& work, const std::array<std::uint32_t, 8>& count,
                   std::span<Piece> pieces) {
    Topology& topology = out_.topology;
    const std::size_t number = level_.first_node + node;
    topology.work[number] = work;
    topology.nodes[number] = {static_cast<std::uint32_t>(topology.nodes.size()), 8,
                              static_cast<std::uint8_t>(level_.number), false};
    const OctreeCell cell{level_.number, level_.cells[node]};
    std::array<std::size_t, 8> to{};
    for (std::uint32_t child = 0; child < 8; ++child) {
      to[child] = next_.begin.back();
      next_.begin.push_back(to[child] + count[child]);
      next_.cells.push_back(cell.child(child).at);
      topology.nodes.push_back({0, 0, static_cast<std::uint8_t>(next_.number), true});
      topology.work.emplace_back();
    }
    for (Piece& piece : pieces) {
      piece.split = true;
      piece.to = to;
      for (std::size_t child = 0; child < 8; ++child) {
        to[child] += piece.count[child];
      }
    }
  }

  void make_leaf(std::size_t node, LevelStatistics& statistics) {
    Topology& topology = out_.topology;
    const std::size_t number = level_.first_node + node;
    const auto count = static_cast<std::uint32_t>(count_of(node));
    topology.work[number].listed = count;
    topology.nodes[number] = {static_cast<std::uint32_t>(topology.entries.size()), count,
                              static_cast<std::uint8_t>(level_.number), true};
    const auto list = std::span(level_.lists).subspan(level_.begin[node], count);
    topology.entries.insert(topology.entries.end(), list.begin(), list.end());
    ++statistics.leaves;
    statistics.entries += count;
    statistics.empty_leaves += count == 0 ? 1U : 0U;
    statistics.overfull_leaves += count > options_.max_objects ? 1U : 0U;
  }

  void scatter() {
    next_.lists.clear();  // everything is overwritten, so nothing need be copied
    require_memory(level_.cells.size(), 0);
    next_.lists.resize(next_.begin.back());
    parallel_pieces(
        pieces_.size(), pieces_at_once, options_.threads, [this](std::size_t begin, std::size_t end) {
          for (std::size_t p = begin; p < end; ++p) {
            Piece& piece = pieces_[p];
            if (!piece.split) {
              continue;
            }
            for (std::size_t at = piece.begin; at < piece.end; ++at) {
              for (std::uint32_t met = children_[at]; met != 0; met &= met - 1) {
                next_.lists[piece.to[static_cast<std::size_t>(std::countr_zero(met))]++] = level_.lists[at];
              }
            }
          }
        });
  }

  const TriangleSet& triangles_;
  const OctreeOptions& options_;
  const RootFrame& frame_;
  const BuildLimit& limit_;
  OctreeBuild& out_;
  Level level_;
  Level next_;
  std::vector<Piece> pieces_;
  std::vector<std::uint8_t> children_;  ///< by entry of level_.lists: the children it goes to, as bits
};

}  // namespace

void check_octree_options(std::string_view structure, const OctreeOptions& options) {
  require_range(structure, "max_objects", options.max_objects, 1, 0x7fffffffU);
  require_range(structure, "max_level", options.max_level, 1, deepest_level);
  require_range(structure, "max_entries", options.max_entries, 1, std::uint64_t{1} << 30);
}

OctreeBuild build_octree(const TriangleSet& triangles, const OctreeOptions& options, const RootFrame& frame,
                         const BuildLimit& limit) {
  OctreeBuild build;
  OctreeBuilder(triangles, options, frame, limit, build).run();
  return build;
}

}  // namespace marti::accel
