// How many arithmetic operations each kind of step takes. The table is not guessed: it is what the real
// templates (camera, traversal, intersection kernel, shading) execute when they are run with a scalar
// that counts, and a test measures it again.
#pragma once

#include <array>
#include <cstdint>

#include "processors/program/render.h"
#include "processors/program/work_log.h"
#include "scenes/scene.h"

namespace marti::accel {
class Structure;
class TriangleSet;
}  // namespace marti::accel

namespace marti::processors {

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
///   branch  everything done between one node visit and the next: ordering children, clipping, popping
///   leaf    nothing but reading it; its record's fetch is priced from the layout
///   test    one run of the intersection kernel for triangles; sphere_test and cone_test the same for spheres
///           and for cylinders and cones
///   shade   the surface point, its normals, ambient light, and finding that a light cannot matter
///   light   one light's contribution
///   texel   interpolating the texture's coordinates, finding the texel, applying it
///   pixel   converting the finished colour
///   cut     with the voxel cut: finding that a node is small and which share of it is covered
/// Fetching a record's words and computing its address is priced from the layout, beside these.
struct OperationMixes {
  std::array<OperationMix, ray_kinds> ray{};
  OperationMix branch;
  OperationMix leaf;
  OperationMix test;
  OperationMix sphere_test;
  OperationMix cone_test;
  OperationMix shade;
  OperationMix light;
  OperationMix texel;
  OperationMix pixel;
  OperationMix cut;
};

/// The table that step_cycles prices. Measured on teapot:12 in an octree (max_objects 9, max_level 12),
/// 128 x 128, depth 2; refraction on gears:2, which has glass; the tests of spheres, cylinders and cones on
/// lattice:4; the texel on a textured square. Sampling
/// the texel and converting the pixel are counted by hand (operation_mix.cpp says how).
[[nodiscard]] const OperationMixes& operation_mixes();

/// What a measurement saw: the means and how many steps they are means of.
struct MeasuredMixes {
  OperationMixes mixes;  ///< a kind of step that did not occur has a mix of zeros
  LogTotals steps;
  std::array<std::uint64_t, 3> tests{};  ///< of `steps.tests`, each accel::PrimitiveKind
};

/// Traces the whole frame on one thread with the counting scalar.
[[nodiscard]] MeasuredMixes measure_operation_mixes(const scenes::Scene& scene,
                                                    const accel::TriangleSet& triangles,
                                                    const accel::Structure& structure,
                                                    const RenderOptions& options);

}  // namespace marti::processors
