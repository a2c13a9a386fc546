// What the voxel cut shades: for each cell that can be smaller than a pixel, the averaged material and normal
// of the surfaces inside it (accel/octree_cut.h says which cells those are).
//
// Averages are weighted by the area that lies inside the cell, every triangle being clipped to every leaf
// that lists it, and a branch being the sum of its children. A triangle exactly in the plane between two
// cells counts in both.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "accel/octree_cut.h"
#include "processors/program/shading.h"
#include "scenes/camera.h"
#include "scenes/scene.h"

namespace marti::processors::program {

/// An averaged material record and its cell.
struct AverageVoxel {
  std::array<std::uint32_t, 3> cell{};  ///< in units of the level's cells, from the root's low corner
  std::uint32_t level = 1;
  accel::SymmetricForm<float> shading{};  ///< sum of area n n' over the shading normals n, up to a factor
  std::array<float, 3> winding{};         ///< mean of the normals that the winding gives, times the area
  std::array<float, 3> color{};           ///< weighted by the diffuse weight too; textures sampled
  std::array<float, 3> specular_color{};  ///< weighted by highlight and reflection too
  std::array<float, 3> emission{};
  float diffuse = 0.0F;
  float reflection = 0.0F;
  float transmission = 0.0F;
  float ior = 1.0F;  ///< weighted by the transmission too
  float highlight = 0.0F;
  float shininess = 1.0F;  ///< weighted by the highlight too

  /// The averages as a material, without a texture.
  [[nodiscard]] scenes::Material material() const;
};

/// The first level whose cells can be small for any ray of a frame. The cell that an eye ray meets is at most
/// as far as the root's farthest corner; every further ray adds at most the root's diagonal. A result beyond
/// the tree's deepest level means that no cell is ever small.
[[nodiscard]] unsigned first_small_level(const scenes::Bounds& root, const scenes::ImagePlane& plane,
                                         double threshold, std::uint32_t max_depth);

/// The voxels of a tree. Immutable once built.
class VoxelAverages {
 public:
  /// Voxels for all nodes of `first_level` and deeper other than empty leaves. On at most `threads` host
  /// threads (0: all of them); the same bytes with any number.
  [[nodiscard]] static VoxelAverages build(const scenes::Scene& scene, const accel::Octree& octree,
                                           unsigned first_level, unsigned threads);

  /// Records of averaged materials follow the scene's materials, in the order of their nodes.
  [[nodiscard]] const accel::VoxelTable& table() const { return table_; }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(voxels_.size()); }
  [[nodiscard]] const AverageVoxel& operator[](std::uint32_t voxel) const { return voxels_[voxel]; }
  [[nodiscard]] const accel::VoxelCover& cover(std::uint32_t voxel) const { return covers_[voxel]; }
  [[nodiscard]] unsigned first_level() const { return first_level_; }

  /// The voxel as a surface seen along the unit `direction`. Its point is the cell's centre and the error of
  /// that is half the cell's size, so that rays start on the plane that touches the cell on their side and
  /// never enter it. The normals are the mean of those inside, turned to the viewer; where they cancel out,
  /// the normal that points to the viewer.
  [[nodiscard]] Surface<double> surface(std::uint32_t voxel, const Vec3<double>& direction) const;

  VoxelAverages(VoxelAverages&&) = default;
  VoxelAverages& operator=(VoxelAverages&&) = default;
  VoxelAverages(const VoxelAverages&) = delete;  // the table points into the vectors
  VoxelAverages& operator=(const VoxelAverages&) = delete;
  ~VoxelAverages() = default;

 private:
  VoxelAverages() = default;

  std::vector<std::uint32_t> voxel_of_;
  std::vector<accel::VoxelCover> covers_;
  std::vector<AverageVoxel> voxels_;
  accel::VoxelTable table_;
  scenes::Bounds root_;
  unsigned first_level_ = 1;
};

/// The structure that a tracer with the voxel cut uses. Keeps references.
class CutStructure : public accel::CutOctree {
 public:
  CutStructure(const accel::Octree& octree, const VoxelAverages& averages, double threshold)
      : CutOctree(octree, averages.table()), averages_(averages), threshold_(threshold) {}

  [[nodiscard]] const accel::TriangleSet& triangles() const { return octree().triangles(); }
  [[nodiscard]] const VoxelAverages& averages() const { return averages_; }
  [[nodiscard]] double threshold() const { return threshold_; }  ///< in pixels, above 0

 private:
  const VoxelAverages& averages_;
  double threshold_;
};

}  // namespace marti::processors::program
