#include "accel/lazy_octree.h"

#include <algorithm>
#include <string>
#include <utility>

#include "sim/error.h"

namespace marti::accel {

namespace {

// A thread keeps its memory for sorting for the next node, up to that for a node with this many triangles.
constexpr std::size_t kept_scratch = std::size_t{1} << 16;

[[noreturn]] void refuse_limit(const OctreeOptions& options) {
  throw sim::UserError("lazy octree: the tree lists max_entries (" + std::to_string(options.max_entries) +
                       ") triangles or more, where a tree built at once would be cut; raise max_entries or "
                       "max_objects, lower max_level, or build the tree at once");
}

}  // namespace

LazyOctree LazyOctree::build(std::shared_ptr<const TriangleSet> triangles, const LazyOctreeOptions& options) {
  sim::ensure(triangles != nullptr, "a lazy octree needs a triangle set, even an empty one");
  check_octree_options(kind_name, options.tree);
  const RootFrame frame = make_frame(*triangles, options.tree.enclose);
  const OctreeBuild build = build_octree(*triangles, options.tree, frame, options.initial);
  return {std::move(triangles), options.tree, frame, build};
}

LazyOctree::LazyOctree(std::shared_ptr<const TriangleSet> triangles, const OctreeOptions& options,
                       const RootFrame& frame, const OctreeBuild& build)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.triangles = std::move(triangles);
  state.options = options;
  state.frame = frame;
  const Topology& topology = build.topology;
  if (build.cut) {
    refuse_limit(options);
  }
  state.listed = topology.entries.size();
  // Both number their nodes breadth-first, so the numbers are the same.
  std::vector<OctreeCell> cells(topology.nodes.size());
  std::size_t unsplit = 0;
  for (std::uint32_t n = 0; n < topology.nodes.size(); ++n) {
    const TopologyNode& from = topology.nodes[n];
    LazyNode& node = state.nodes[n];
    if (!from.leaf) {
      node.first = state.nodes.add_children();
      sim::ensure(node.first == from.first, "a lazy octree's nodes are numbered like those it is made of");
      for (std::uint32_t child = 0; child < 8; ++child) {
        cells[node.first + child] = cells[n].child(child);
        const TopologyNode& below = topology.nodes[node.first + child];
        node.info =
            (child == 0 ? 0U : node.info.load()) | (!below.leaf || below.count > 0 ? 1U << child : 0U);
      }
      continue;
    }
    const std::span<const std::uint32_t> list(topology.entries.data() + from.first, from.count);
    if (unsplit < build.unsplit.size() && build.unsplit[unsplit] == n) {
      ++unsplit;
      place_pending(node, cells[n], list);
    } else {
      place_leaf(state, node, list);
    }
  }
}

LazyOctree::LazyOctree(LazyOctree&&) noexcept = default;
LazyOctree& LazyOctree::operator=(LazyOctree&&) noexcept = default;
LazyOctree::~LazyOctree() = default;

const TriangleSet& LazyOctree::triangles() const { return *state_->triangles; }
const OctreeOptions& LazyOctree::options() const { return state_->options; }
const scenes::Bounds& LazyOctree::bounds() const { return state_->frame.box; }

const Topology& LazyOctree::topology() const {
  throw sim::UserError(
      "a lazy octree changes while rays are traced, so that no work log of them can be recorded; record with "
      "an octree that is built at once");
}

void LazyOctree::place_pending(LazyNode& node, const OctreeCell& cell, std::span<const std::uint32_t> list) {
  node.waiting = new PendingNode{cell, {list.begin(), list.end()}};
  node.info.store(LazyNode::pending, std::memory_order_relaxed);
}

void LazyOctree::place_leaf(State& state, LazyNode& node, std::span<const std::uint32_t> list) {
  std::uint32_t* copy = state.nodes.add_list(list.size());
  std::copy(list.begin(), list.end(), copy);
  node.list = copy;
  node.info.store(OctreeNode::leaf_bit | static_cast<std::uint32_t>(list.size()), std::memory_order_relaxed);
}

std::uint32_t LazyOctree::resolve(State& state, LazyNode& node) {
  for (;;) {
    std::uint32_t info = LazyNode::pending;
    if (node.info.compare_exchange_strong(info, LazyNode::building, std::memory_order_acquire)) {
      // Waiting threads must be woken even after a failure; the next of them then tries to divide the node.
      struct Publish {
        LazyNode& node;
        std::uint32_t info = LazyNode::pending;
        ~Publish() {
          node.info.store(info, std::memory_order_release);
          node.info.notify_all();
        }
      } publish{node};
      publish.info = divide(state, node);
      return publish.info;
    }
    if (!LazyNode::is_pending(info)) {
      // Divided by another thread; the acquire makes its writes visible.
      return node.info.load(std::memory_order_acquire);
    }
    node.info.wait(LazyNode::building, std::memory_order_acquire);
    info = node.info.load(std::memory_order_acquire);
    if (!LazyNode::is_pending(info)) {
      return info;
    }
  }
}

std::uint32_t LazyOctree::divide(State& state, LazyNode& node) {
  const OctreeCell cell = node.waiting->cell;
  const std::vector<std::uint32_t>& list = node.waiting->list;
  thread_local SortedChildren sorted;
  sort_into_children(*state.triangles, state.frame, cell, list, sorted);
  std::uint32_t info = 0;
  if (separates_nothing(sorted, list.size())) {
    std::uint32_t* copy = state.nodes.add_list(list.size());
    std::copy(list.begin(), list.end(), copy);
    node.list = copy;
    info = OctreeNode::leaf_bit | static_cast<std::uint32_t>(list.size());
  } else {
    std::uint64_t listed = 0;
    for (const auto& child : sorted.lists) {
      listed += child.size();
    }
    // Computed modulo 2^64, as the children may list fewer triangles than their parent.
    const std::uint64_t more = listed - list.size();
    if (state.listed.fetch_add(more, std::memory_order_relaxed) + more >= state.options.max_entries) {
      state.listed.fetch_sub(more, std::memory_order_relaxed);
      refuse_limit(state.options);
    }
    const std::uint32_t first = state.nodes.add_children();
    const bool below_splits = level_splits(state.frame, state.options.max_level, cell.level + 1);
    for (std::uint32_t child = 0; child < 8; ++child) {
      const std::vector<std::uint32_t>& below = sorted.lists[child];
      if (below_splits && below.size() > state.options.max_objects) {
        place_pending(state.nodes[first + child], cell.child(child), below);
      } else {
        place_leaf(state, state.nodes[first + child], below);
      }
      info |= below.empty() ? 0U : 1U << child;
    }
    node.first = first;
  }
  if (list.size() > kept_scratch) {
    sorted = {};
  }
  delete std::exchange(node.waiting, nullptr);
  state.subdivided.fetch_add(1, std::memory_order_relaxed);
  return info;
}

void LazyOctree::subdivide(std::uint32_t node) const {
  sim::ensure(node < state_->nodes.size(), "a lazy octree was asked for a node that it has not");
  (void)view().node(node);
}

void LazyOctree::expand() const {
  const View nodes = view();
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const View::Record record = nodes.node(stack.back());
    stack.pop_back();
    for (std::uint32_t child = 0; !record.leaf() && child < 8; ++child) {
      stack.push_back(record.first + child);
    }
  }
}

LazyOctreeState LazyOctree::state() const {
  LazyOctreeState result;
  const OctreeBuild now = snapshot();
  std::size_t unsplit = 0;
  for (std::uint32_t n = 0; n < now.topology.nodes.size(); ++n) {
    const TopologyNode& node = now.topology.nodes[n];
    result.levels.resize(std::max<std::size_t>(result.levels.size(), node.level));
    LazyOctreeState::Level& level = result.levels[node.level - 1U];
    if (!node.leaf) {
      ++level.branches;
    } else if (unsplit < now.unsplit.size() && now.unsplit[unsplit] == n) {
      ++unsplit;
      ++level.pending;
      level.pending_entries += node.count;
    } else {
      ++level.leaves;
      level.leaf_entries += node.count;
    }
  }
  for (const LazyOctreeState::Level& level : result.levels) {
    result.all.branches += level.branches;
    result.all.leaves += level.leaves;
    result.all.pending += level.pending;
    result.all.leaf_entries += level.leaf_entries;
    result.all.pending_entries += level.pending_entries;
  }
  result.node_bytes = result.all.nodes() * sizeof(LazyNode) + result.all.pending * sizeof(PendingNode);
  result.list_bytes = (result.all.leaf_entries + result.all.pending_entries) * sizeof(std::uint32_t);
  result.subdivided = state_->subdivided;
  return result;
}

std::vector<std::uint32_t> LazyOctree::pending() const {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t n = 0; n < state_->nodes.size(); ++n) {
    if (LazyNode::is_pending(state_->nodes[n].info)) {
      numbers.push_back(n);
    }
  }
  return numbers;
}

OctreeBuild LazyOctree::snapshot() const {
  OctreeBuild build;
  Topology& topology = build.topology;
  std::vector<std::uint32_t> here{0};  // numbers in this tree of the nodes of the present level
  topology.nodes.emplace_back();
  std::size_t next = 0;  // number in the snapshot
  for (std::uint8_t number = 1; !here.empty(); ++number) {
    LevelStatistics& level = build.levels.emplace_back();
    std::vector<std::uint32_t> below;
    for (const std::uint32_t n : here) {
      const LazyNode& node = state_->nodes[n];
      const std::uint32_t info = node.info.load();
      const bool waits = LazyNode::is_pending(info);
      if (!waits && (info & OctreeNode::leaf_bit) == 0) {
        ++level.branches;
        topology.nodes[next++] = {static_cast<std::uint32_t>(topology.nodes.size()), 8, number, false};
        topology.nodes.resize(topology.nodes.size() + 8);
        for (std::uint32_t child = 0; child < 8; ++child) {
          below.push_back(node.first + child);
        }
        continue;
      }
      if (waits) {
        build.unsplit.push_back(static_cast<std::uint32_t>(next));
      }
      const auto list = waits ? std::span<const std::uint32_t>(node.waiting->list)
                              : std::span(node.list, info & ~OctreeNode::leaf_bit);
      topology.nodes[next++] = {static_cast<std::uint32_t>(topology.entries.size()),
                                static_cast<std::uint32_t>(list.size()), number, true};
      topology.entries.insert(topology.entries.end(), list.begin(), list.end());
      ++level.leaves;
      level.entries += list.size();
      level.empty_leaves += list.empty() ? 1U : 0U;
      level.overfull_leaves += list.size() > state_->options.max_objects ? 1U : 0U;
    }
    here.swap(below);
  }
  return build;
}

}  // namespace marti::accel
