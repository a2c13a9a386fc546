#include "accel/structure.h"

#include <array>

namespace marti::accel {

namespace {

constexpr std::array<std::string_view, 4> kinds{Octree::kind_name, Bsp::kind_name, Grid::kind_name,
                                                BruteForce::kind_name};

}  // namespace

std::span<const std::string_view> structure_kinds() { return kinds; }

std::unique_ptr<Structure> make_structure(std::string_view kind, std::shared_ptr<const TriangleSet> triangles,
                                          const StructureOptions& options) {
  if (kind == Octree::kind_name) {
    return std::make_unique<StructureOf<Octree>>(Octree::build(std::move(triangles), options.octree));
  }
  if (kind == Bsp::kind_name) {
    return std::make_unique<StructureOf<Bsp>>(Bsp::build(std::move(triangles), options.bsp));
  }
  if (kind == Grid::kind_name) {
    return std::make_unique<StructureOf<Grid>>(Grid::build(std::move(triangles), options.grid));
  }
  if (kind == BruteForce::kind_name) {
    return std::make_unique<StructureOf<BruteForce>>(BruteForce(std::move(triangles)));
  }
  std::string message("unknown structure \"");
  message.append(kind).append("\"; there are \"octree\", \"bsp\", \"grid\" and \"none\" (brute force)");
  throw sim::UserError(message);
}

std::unique_ptr<Structure> make_lazy_octree(std::shared_ptr<const TriangleSet> triangles,
                                            const LazyOctreeOptions& options) {
  return std::make_unique<StructureOf<LazyOctree>>(LazyOctree::build(std::move(triangles), options));
}

}  // namespace marti::accel
