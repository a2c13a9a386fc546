// How many arithmetic operations each kind of step takes. The table is measured: it holds what the real
// templates (camera, traversal, intersection kernel, shading) execute when run with a scalar that counts. A
// test measures it again. Every traversal has a table of its own.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "accel/counted.h"
#include "accel/ray.h"
#include "accel/traversal.h"
#include "processors/program/render.h"
#include "processors/program/work_log.h"
#include "scenes/scene.h"

namespace marti::accel {
class Structure;
class TriangleSet;
}  // namespace marti::accel

namespace marti::processors::cost {

/// Mean operations of one step, in thousandths of an operation.
struct OperationMix {
  std::int64_t add = 0;
  std::int64_t multiply = 0;
  std::int64_t divide = 0;
  std::int64_t square_root = 0;
  std::int64_t compare = 0;
  std::int64_t integer = 0;

  bool operator==(const OperationMix&) const = default;
};

/// One mix for each kind of step that StepCycles prices. What belongs to which:
///   ray     making the ray (camera arithmetic, or the secondary direction and its origin out of the
///           surface), setting up kernel and traversal, and the background where it misses
///   branch  octree, recursive BSP tree, bounding volume hierarchy: everything done between one node visit
///           and the next: ordering children, clipping or testing boxes, popping. Pushed points: choosing a
///           branch's half on the way from the root. Grid: nothing, its header is read once
///   transform   bringing the ray into a mesh's coordinates, and setting up kernel and traversal there
///   leaf    octree, recursive BSP tree: nothing but reading it; its record's fetch is priced from the
///           layout. Bounding volume hierarchy: nothing, it has no record. Pushed points: finding the face by
///           which the leaf is left, and the point beyond it. Grid: the step to the next cell
///   lookup  comparing a mailbox with the ray's number
///   test    one run of the kernel for triangles; sphere_test and cone_test: one of the kernels for spheres
///           and for cylinders and cones
///   shade   the surface point, its normals, ambient light, and finding that a light cannot matter
///   light   one light's contribution
///   path_shade, path_light   these with Integrator::path: drawing the point of an emissive triangle and the
///           way on is a part of shading; the light is an emissive triangle
///   texel   interpolating the texture's coordinates, finding the texel, applying it
///   any_hit the corners' weights at a hit of a triangle with holes, and the texel's alpha compared
///   meet    how near a ray comes to a Gaussian, and its place among the nearest
///   collect a record of a Gaussian's colour, and its share of the alpha and of adding it
///   pixel   converting the finished colour
///   cut     with the voxel cut: finding that a node is small and which share of it is covered
/// Fetching a record's words and computing its address is priced from the layout, beside these.
struct OperationMixes {
  std::array<OperationMix, program::ray_kinds> ray{};
  OperationMix branch;
  OperationMix transform;
  OperationMix leaf;
  OperationMix lookup;
  OperationMix test;
  OperationMix sphere_test;
  OperationMix cone_test;
  OperationMix shade;
  OperationMix light;
  OperationMix path_shade;
  OperationMix path_light;
  OperationMix texel;
  OperationMix pixel;
  OperationMix cut;
  OperationMix any_hit;
  OperationMix meet;
  OperationMix collect;
};

/// The table that step_cycles prices. Measured on teapot:12 in an octree or a BSP tree (max_objects 9,
/// max_level 12), a grid (density 4) or a bounding volume hierarchy (at most 3 in a leaf), 128 x 128, depth
/// 2; brute force on teapot:4, 32 x 32; refraction on gears:2, which has glass; scattered rays, shading and
/// lights of paths on teapot:12 under an emissive square; the tests of spheres, cylinders and cones on
/// lattice:4 in the octree; the texel on a textured square; the transform on instances of a teapot. Sampling
/// the texel and converting the pixel are counted by hand (operation_mix.cpp says how).
[[nodiscard]] const OperationMixes& operation_mixes(accel::Traversal traversal);

/// The result of a measurement: the means, and how many steps they are means of.
struct MeasuredMixes {
  OperationMixes mixes;  ///< all zero for a kind of step that did not occur
  program::LogTotals steps;
  std::array<std::uint64_t, 3> tests{};  ///< of `steps.tests`, each accel::PrimitiveKind
};

/// Traces the whole frame on one thread with the counting scalar, with mailboxes where the options say so.
[[nodiscard]] MeasuredMixes measure_operation_mixes(const scenes::Scene& scene,
                                                    const accel::TriangleSet& triangles,
                                                    const accel::Structure& structure,
                                                    const program::RenderOptions& options);

/// `meet` and `collect` of operation_mixes(), of Gaussians of degree 3 whose colour is three records.
[[nodiscard]] std::array<OperationMix, 2> measure_gaussians();

/// Operations that some rays took: sums, not means.
struct MeasuredWalks {
  accel::OperationCounts ray;  ///< setting up kernel and traversal
  accel::OperationCounts branch;
  accel::OperationCounts leaf;
  accel::OperationCounts test;
  program::LogTotals steps;
};

/// Finds the nearest hit of each ray with the counting scalar, without mailboxes.
[[nodiscard]] MeasuredWalks measure_walks(const accel::Structure& structure,
                                          std::span<const accel::Ray> rays);

/// Counted operations over the number of steps (or splits) that they were counted in, in thousandths, rounded
/// to the nearest; all 0 without steps.
[[nodiscard]] OperationMix mean_mix(const accel::OperationCounts& counts, std::uint64_t steps);

}  // namespace marti::processors::cost
