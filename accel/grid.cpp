#include "accel/grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "accel/build_memory.h"
#include "accel/primitive_overlap.h"

namespace marti::accel {

namespace {

using Resolution = std::array<std::uint32_t, 3>;

constexpr std::uint32_t most_along_an_axis = 1U << 20U;

std::uint64_t cells_of(const Resolution& n) { return std::uint64_t{n[0]} * n[1] * n[2]; }

glm::dvec3 extent_of(const RootFrame& frame) { return frame.box.hi - frame.box.lo; }

/// The numbers of cubes of equal size that fill the box with about `cells` cubes; an axis shorter than such a
/// cube gets one cell, and the other axes get more.
Resolution resolution_for(const RootFrame& frame, double cells) {
  const glm::dvec3 extent = extent_of(frame);
  Resolution n{0, 0, 0};  // 0: not yet settled
  for (int a = 0; a < 3; ++a) {
    n[static_cast<std::size_t>(a)] = extent[a] > 0.0 ? 0U : 1U;  // 0: all primitives are a point in the
                                                                 // origin
  }
  for (;;) {
    double log_volume = 0.0;  // a product of three extents could overflow
    int open = 0;
    for (int a = 0; a < 3; ++a) {
      if (n[static_cast<std::size_t>(a)] == 0) {
        log_volume += std::log2(extent[a]);
        ++open;
      }
    }
    if (open == 0) {
      return n;
    }
    const double size = std::exp2((log_volume - std::log2(cells)) / open);
    bool settled = false;
    for (int a = 0; a < 3; ++a) {
      if (n[static_cast<std::size_t>(a)] == 0 && !(extent[a] >= size)) {
        n[static_cast<std::size_t>(a)] = 1;
        settled = true;
      }
    }
    if (settled) {
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      if (n[static_cast<std::size_t>(a)] == 0) {
        n[static_cast<std::size_t>(a)] = static_cast<std::uint32_t>(
            std::clamp(std::round(extent[a] / size), 1.0, 1.0 * most_along_an_axis));
      }
    }
    return n;
  }
}

void halve(Resolution& n) {
  for (std::uint32_t& along : n) {
    along = std::max(along / 2, 1U);
  }
}

/// The resolution that the options ask for; a density that asks for more than `most` cells gets `most`.
Resolution asked_for(const RootFrame& frame, const GridOptions& options, std::uint32_t triangles,
                     double most) {
  const Resolution& n = options.resolution;
  if (std::find(n.begin(), n.end(), 0U) == n.end()) {
    return n;
  }
  return resolution_for(frame, std::min(std::max(1.0, options.density * triangles), most));
}

Resolution choose_resolution(const RootFrame& frame, const GridOptions& options, std::uint32_t triangles) {
  Resolution n = asked_for(frame, options, triangles, static_cast<double>(options.max_cells));
  const glm::dvec3 extent = extent_of(frame);
  for (int a = 0; a < 3; ++a) {
    const double thinnest = std::max(8.0 * frame.delta, 0x1p-1000);
    auto& along = n[static_cast<std::size_t>(a)];
    along = static_cast<std::uint32_t>(std::clamp(std::floor(extent[a] / thinnest), 1.0, 1.0 * along));
  }
  while (cells_of(n) > options.max_cells) {
    *std::max_element(n.begin(), n.end()) -= std::max(*std::max_element(n.begin(), n.end()) / 64, 1U);
  }
  return n;
}

std::array<std::vector<double>, 3> planes_of(const RootFrame& frame, const Resolution& n) {
  std::array<std::vector<double>, 3> planes;
  for (std::size_t a = 0; a < 3; ++a) {
    const double lo = frame.box.lo[static_cast<int>(a)];
    const double hi = frame.box.hi[static_cast<int>(a)];
    planes[a].resize(std::size_t{n[a]} + 1);
    for (std::uint32_t i = 0; i < n[a]; ++i) {
      planes[a][i] = lo + (hi - lo) * (static_cast<double>(i) / n[a]);
    }
    planes[a][n[a]] = hi;
  }
  return planes;
}

/// Calls f(cell) for each cell, enlarged by delta, that the primitive meets.
template <class F>
void for_cells(const TriangleSet& set, std::uint32_t id, const std::array<std::vector<double>, 3>& planes,
               double delta, const F& f) {
  std::array<std::size_t, 3> begin{};
  std::array<std::size_t, 3> end{};
  bool one = true;
  for (std::size_t a = 0; a < 3; ++a) {
    const Extent<double> extent = extent_of<double>(set, id, a);
    const double lo = extent.lo - delta;
    const double hi = extent.hi + delta;
    // The first cell whose upper plane is not below the primitive, the last whose lower plane is not above.
    const auto first = planes[a].begin();
    begin[a] = static_cast<std::size_t>(std::lower_bound(first + 1, planes[a].end() - 1, lo) - first) - 1;
    end[a] = static_cast<std::size_t>(std::upper_bound(first + 1, planes[a].end() - 1, hi) - first);
    one = one && end[a] - begin[a] == 1;
  }
  const std::size_t nx = planes[0].size() - 1;
  const std::size_t ny = planes[1].size() - 1;
  if (one) {
    f(begin[0] + nx * (begin[1] + ny * begin[2]));
    return;
  }
  glm::dvec3 center;
  glm::dvec3 half;
  const auto place = [&](std::size_t axis, std::size_t i) {
    const int a = static_cast<int>(axis);
    center[a] = 0.5 * (planes[axis][i] + planes[axis][i + 1]);
    half[a] = 0.5 * (planes[axis][i + 1] - planes[axis][i]) + delta;
  };
  for (std::size_t z = begin[2]; z < end[2]; ++z) {
    place(2, z);
    for (std::size_t y = begin[1]; y < end[1]; ++y) {
      place(1, y);
      for (std::size_t x = begin[0]; x < end[0]; ++x) {
        place(0, x);
        if (overlaps(set, id, center, half)) {
          f(x + nx * (y + ny * z));
        }
      }
    }
  }
}

}  // namespace

Grid Grid::build(std::shared_ptr<const TriangleSet> triangles, const GridOptions& options) {
  sim::ensure(triangles != nullptr, "a grid needs a triangle set, even an empty one");
  if (!(options.density > 0.0 && options.density <= 0x1p20)) {
    throw sim::UserError("grid: density must be above 0 and at most 1048576");
  }
  for (const std::uint32_t along : options.resolution) {
    require_range(kind_name, "resolution", along, 0, most_along_an_axis);
  }
  require_range(kind_name, "max_cells", options.max_cells, 1, std::uint64_t{1} << 27);
  require_range(kind_name, "max_entries", options.max_entries, 1, std::uint64_t{1} << 30);
  Grid grid;
  grid.triangles_ = std::move(triangles);
  grid.options_ = options;
  const TriangleSet& set = *grid.triangles_;
  if (set.size() == 0) {
    grid.topology_.nodes.push_back({0, 0, 1, true});
    return grid;
  }
  grid.frame_ = make_frame(set);
  grid.requested_ = asked_for(grid.frame_, options, set.size(), 0x1p53);
  grid.resolution_ = choose_resolution(grid.frame_, options, set.size());

  const auto ask = [&](std::uint32_t id) {
    if (id % nodes_between_checks == 0) {
      options.memory.end_if_stopped();
    }
  };
  std::vector<std::uint32_t> counts;
  for (;; halve(grid.resolution_)) {
    grid.planes_ = planes_of(grid.frame_, grid.resolution_);
    const auto require = [&](std::uint64_t listed) {
      options.memory.require(cells_of(grid.resolution_) * (sizeof(std::uint32_t) + sizeof(TopologyNode)) +
                                 listed * sizeof(std::uint32_t),
                             "the grid takes", "lower structure.grid_density");
    };
    require(0);
    counts.assign(cells_of(grid.resolution_), 0);
    std::uint64_t entries = 0;
    const bool coarsest = counts.size() == 1;
    for (std::uint32_t id = 0; id < set.size() && (coarsest || entries <= options.max_entries); ++id) {
      ask(id);
      for_cells(set, id, grid.planes_, grid.frame_.delta, [&](std::size_t cell) {
        ++counts[cell];
        ++entries;
      });
    }
    if (coarsest || entries <= options.max_entries) {
      require(entries);
      break;
    }
  }
  for (unsigned axis = 0; axis < 3; ++axis) {
    const int a = static_cast<int>(axis);
    const double extent = grid.frame_.box.hi[a] - grid.frame_.box.lo[a];
    grid.cells_per_length_[axis] = grid.resolution_[axis] / extent;
  }
  std::vector<TopologyNode>& nodes = grid.topology_.nodes;
  nodes.reserve(counts.size() + 1);
  nodes.push_back({1, static_cast<std::uint32_t>(counts.size()), 1, false});
  std::uint32_t first = 0;
  for (std::uint32_t& count : counts) {
    nodes.push_back({first, count, 2, true});
    first += std::exchange(count, first);
  }
  grid.topology_.entries.resize(first);
  for (std::uint32_t id = 0; id < set.size(); ++id) {
    ask(id);
    for_cells(set, id, grid.planes_, grid.frame_.delta,
              [&](std::size_t cell) { grid.topology_.entries[counts[cell]++] = id; });
  }
  return grid;
}

std::uint32_t Grid::cell_at(unsigned axis, double cells) const {
  const double last = resolution_[axis] - 1.0;
  const double cell = std::floor(cells);
  return cell >= last ? resolution_[axis] - 1 : cell > 0.0 ? static_cast<std::uint32_t>(cell) : 0U;
}

}  // namespace marti::accel
