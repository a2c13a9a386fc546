#include "accel/structure.h"

#include <array>
#include <type_traits>

#include "sim/key_error.h"

namespace marti::accel {

namespace {

constexpr std::array<std::string_view, 5> kinds{Octree::kind_name, Bsp::kind_name, Grid::kind_name,
                                                Bvh::kind_name, BruteForce::kind_name};

}  // namespace

std::span<const std::string_view> structure_kinds() { return kinds; }

std::unique_ptr<Structure> make_structure(std::string_view kind, std::shared_ptr<const TriangleSet> triangles,
                                          const StructureOptions& options) {
  if (!triangles->instances().empty()) {
    if (kind != Bvh::kind_name) {
      throw sim::KeyError("structure.instances",
                          "only a bvh has a level for instances, and structure.kind is \"" +
                              std::string(kind) + "\"; set \"copied\"");
    }
    return std::make_unique<StructureOf<TwoLevelBvh>>(TwoLevelBvh::build(std::move(triangles), options.bvh));
  }
  if (kind == Octree::kind_name) {
    return std::make_unique<StructureOf<Octree>>(Octree::build(std::move(triangles), options.octree));
  }
  if (kind == Bsp::kind_name) {
    return std::make_unique<StructureOf<Bsp>>(Bsp::build(std::move(triangles), options.bsp));
  }
  if (kind == Grid::kind_name) {
    GridOptions grid = options.grid;
    if (options.grid_match != GridMatch::density) {
      grid = matched_to(Octree::build(triangles, options.octree), options.grid_match, grid);
    }
    return std::make_unique<StructureOf<Grid>>(Grid::build(std::move(triangles), grid));
  }
  if (kind == Bvh::kind_name) {
    return std::make_unique<StructureOf<Bvh>>(Bvh::build(std::move(triangles), options.bvh));
  }
  if (kind == BruteForce::kind_name) {
    return std::make_unique<StructureOf<BruteForce>>(BruteForce(std::move(triangles)));
  }
  std::string message("unknown structure \"");
  message.append(kind).append(
      "\"; there are \"octree\", \"bsp\", \"grid\", \"bvh\" and \"none\" (brute force)");
  throw sim::UserError(message);
}

std::unique_ptr<Structure> make_lazy_octree(std::shared_ptr<const TriangleSet> triangles,
                                            const LazyOctreeOptions& options) {
  return std::make_unique<StructureOf<LazyOctree>>(LazyOctree::build(std::move(triangles), options));
}

std::uint64_t host_bytes(const Structure& structure) {
  const Topology& topology = structure.topology();
  const std::uint64_t records =
      structure.kind() == Octree::kind_name ? Octree::walk_bytes(topology, structure.triangles()) : 0;
  const std::uint64_t planes =
      structure.kind() == Bsp::kind_name ? sizeof(double) * topology.nodes.size() : 0;
  const auto* bvh = dynamic_cast<const StructureOf<Bvh>*>(&structure);
  const auto* levels = dynamic_cast<const StructureOf<TwoLevelBvh>*>(&structure);
  return bytes_of(topology) + records + planes + (bvh == nullptr ? 0 : bvh->concrete().walk_bytes()) +
         (levels == nullptr ? 0 : levels->concrete().walk_bytes());
}

Traversal traversal_of(const Structure& structure) {
  return visit_structure(structure, [](const auto& concrete) {
    using Concrete = std::remove_cvref_t<decltype(concrete)>;
    if constexpr (std::is_same_v<Concrete, Octree> || std::is_same_v<Concrete, LazyOctree>) {
      return Traversal::octree;
    } else if constexpr (std::is_same_v<Concrete, Bsp> || std::is_same_v<Concrete, Bvh> ||
                         std::is_same_v<Concrete, TwoLevelBvh>) {
      return concrete.traversal();
    } else if constexpr (std::is_same_v<Concrete, Grid>) {
      return Traversal::grid;
    } else {
      static_assert(std::is_same_v<Concrete, BruteForce>);
      return Traversal::none;
    }
  });
}

}  // namespace marti::accel
