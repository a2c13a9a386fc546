// The work log: what the ray tracer did, pixel by pixel, without cycles and without addresses.
//
// A pixel is a run of 32-bit words: step kind in the top 4 bits, operand in the lower 28. A leaf's tests
// are not written: they follow from the leaf (every entry is tested, in list order), except when an
// occlusion query ended early, which partial_leaf records with its count in a second word, and when mailboxes
// left tests out, which mailed_leaf records with a bit for each entry. Words are kept per image row, so rows
// are recorded on any number of host threads and give the same bytes.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <span>
#include <string_view>
#include <vector>

#include "accel/quadric_shape.h"
#include "accel/topology.h"
#include "accel/traversal.h"
#include "accel/walk_order.h"
#include "sim/chunks.h"

namespace marti::processors::program {

/// Which light the program follows: mirror images and refractions only, or also the light that surfaces
/// scatter to each other; or none, and it finds what given rays hit, or looks through Gaussians (tracer.h).
enum class Integrator : std::uint8_t { whitted, path, rays, shadow, occlusion, gaussians };
inline constexpr std::array<std::string_view, 6> integrator_names = {"whitted", "path",      "rays",
                                                                     "shadow",  "occlusion", "gaussians"};
/// Whether points of emissive triangles are asked for light, as one light beside the scene's own.
[[nodiscard]] constexpr bool asks_emitters(Integrator integrator) {
  return integrator == Integrator::path || integrator == Integrator::shadow;
}
/// Whether each camera ray that hits sends a number of rays that any hit ends, and nothing is shaded.
[[nodiscard]] constexpr bool sends_any_hit_rays(Integrator integrator) {
  return integrator == Integrator::shadow || integrator == Integrator::occlusion;
}

/// Kinds of ray, in the order statistics list them. Diffuse rays are those that a scattering surface sends on
/// in a random direction; only Integrator::path has them.
enum class RayKind : std::uint8_t { camera, shadow, reflection, refraction, diffuse };
inline constexpr std::size_t ray_kinds = 5;
inline constexpr std::array<std::string_view, ray_kinds> ray_kind_names = {"camera", "shadow", "reflection",
                                                                           "refraction", "diffuse"};

/// The operand of a `ray` step. The bounce is the number of surface points between the eye and the ray's
/// origin: 0 for camera rays, 1 for the rays that start where a camera ray ends. With Integrator::rays those
/// of which the closest hit is wanted are camera rays, the others shadow rays, and all have bounce 0. The
/// rays of Integrator::occlusion are shadow rays, and the sky about the point is their light. With
/// Integrator::gaussians a camera ray goes on, in rounds, as refraction rays, whose bounce is that of the one
/// before and 1.
inline constexpr unsigned ray_kind_bits = 3;
[[nodiscard]] constexpr std::uint32_t ray_operand(RayKind kind, std::uint32_t bounce) {
  return static_cast<std::uint32_t>(kind) | bounce << ray_kind_bits;
}
[[nodiscard]] constexpr RayKind ray_kind_of(std::uint32_t operand) {
  return static_cast<RayKind>(operand & ((1U << ray_kind_bits) - 1U));
}
/// The kind as an index.
[[nodiscard]] constexpr std::size_t ray_number_of(std::uint32_t operand) {
  return static_cast<std::size_t>(ray_kind_of(operand));
}
[[nodiscard]] constexpr std::uint32_t bounce_of(std::uint32_t operand) { return operand >> ray_kind_bits; }

/// What a word of the log says.
enum class Step : std::uint32_t {
  branch,        ///< operand: node. A branch record was read and its children ordered.
  leaf,          ///< operand: node. A leaf record was read; all its entries were tested.
  partial_leaf,  ///< operand: node; second word: how many of its entries were tested.
  ray,           ///< operand: ray_operand(). A ray was set up and its traversal begins.
  shade,         ///< operand: material. A hit point, normal and local colour were computed. With
          ///< Integrator::gaussians: a record of a Gaussian's coefficients was read, and its part of the
          ///< colour added.
  light,  ///< operand: light. One unoccluded light's contribution was added.
  texel,  ///< operand: texture; second word: texel index in the texture. A texel was read.
  cut,    ///< operand: node. Its record was read and the node taken as one voxel (accel/octree_cut.h);
          ///< the shade of its averaged material follows.
  pass,   ///< operand: material. The averaged material of a node was read, but too little of the node is
          ///< covered to take it as a voxel; its branch, leaf or partial_leaf follows.
  mailed_leaf,  ///< operand: node; second word: how many of its entries were looked up in the mailboxes;
                ///< then one bit for each of them, from the lowest bit of the first word on: was it tested?
                ///< The last word's other bits are 0. At least one was not.
  any_hit,  ///< operand: material. Whether a hit counts was found out: its coordinates were computed and the
            ///< material read; the texel that decides follows. Behind the leaf with the triangle. With
            ///< Integrator::gaussians the operand is the first record of a Gaussian, which was read and put
            ///< among the nearest if it is one of them; no texel follows.
  transform,  ///< operand: node, an instance. Its transform was read and the ray brought into the coordinates
              ///< of its mesh.
};

inline constexpr unsigned operand_bits = 28;
inline constexpr std::uint32_t max_operand = (1U << operand_bits) - 1U;

[[nodiscard]] constexpr std::uint32_t make_word(Step step, std::uint32_t operand) {
  return (static_cast<std::uint32_t>(step) << operand_bits) | operand;
}
[[nodiscard]] constexpr Step step_of(std::uint32_t word) { return static_cast<Step>(word >> operand_bits); }
[[nodiscard]] constexpr std::uint32_t operand_of(std::uint32_t word) { return word & max_operand; }
/// Number of 32-bit words that hold one bit for each of so many entries.
[[nodiscard]] constexpr std::uint32_t mask_words(std::uint32_t entries) {
  return entries / 32 + (entries % 32 != 0 ? 1 : 0);
}
/// The step that sets up a camera ray.
inline constexpr std::uint32_t camera_ray = make_word(Step::ray, 0);
/// Whether a step is the visit to a branch or to a whole leaf, as nearly all steps are. Such a step is one
/// word, and its kind one of the two lowest, so that one comparison suffices.
[[nodiscard]] constexpr bool whole_visit(std::uint32_t word) {
  static_assert(static_cast<std::uint32_t>(Step::branch) == 0 && static_cast<std::uint32_t>(Step::leaf) == 1);
  return word < make_word(Step::partial_leaf, 0);
}
/// Number of words of the step that begins at `word`, its raw operands included.
[[nodiscard]] constexpr std::size_t step_words(const std::uint32_t* word) {
  if (whole_visit(*word)) {
    return 1;
  }
  switch (step_of(*word)) {
    case Step::partial_leaf:
    case Step::texel:
      return 2;
    case Step::mailed_leaf:
      return std::size_t{2} + mask_words(word[1]);
    default:
      return 1;
  }
}
/// Whether a step reads a tree node, which is its operand.
[[nodiscard]] constexpr bool visits_node(Step step) {
  return step == Step::branch || step == Step::leaf || step == Step::partial_leaf ||
         step == Step::mailed_leaf || step == Step::cut || step == Step::transform;
}
/// Number of words of the any_hit at `word`, with its texel if it has one. Another step follows in the log.
[[nodiscard]] constexpr std::size_t any_hit_words(const std::uint32_t* word) {
  return step_of(word[1]) == Step::texel ? 3 : 1;
}
/// Whether entry number `entry` was tested, according to a mailed_leaf's mask.
[[nodiscard]] constexpr bool tested_in_mask(const std::uint32_t* mask, std::uint32_t entry) {
  return ((mask[entry / 32] >> (entry % 32)) & 1U) != 0;
}
/// The tests of a mailed_leaf: bits set in its mask.
[[nodiscard]] constexpr std::uint32_t tests_of_mask(const std::uint32_t* mask, std::uint32_t entries) {
  std::uint32_t tests = 0;
  for (std::uint32_t i = 0; i < mask_words(entries); ++i) {
    tests += static_cast<std::uint32_t>(std::popcount(mask[i]));
  }
  return tests;
}

/// Words of the pixels of an image row, from left to right: those of pixel x are words[begin[x] .. begin[x +
/// 1]).
struct RowWords {
  sim::ChunkVector<std::uint32_t> words;
  sim::ChunkVector<std::uint32_t> begin;  ///< width + 1 offsets; empty if the row has no such words

  [[nodiscard]] std::span<const std::uint32_t> pixel(std::uint32_t x) const {
    return std::span(words).subspan(begin[x], begin[x + 1] - begin[x]);
  }
};

/// One image row: its steps, and what stands beside them where it is asked for (RenderOptions).
struct LogRow : RowWords {
  RowWords entered;  ///< of each visit to a branch or an instance an accel::EnteredChildren
  RowWords rays;     ///< a word for each ray (ray_grid.h)
  RowWords meets;    ///< what each ray meets (accel/bvh_meets.h)

  [[nodiscard]] std::array<const RowWords*, 3> beside() const { return {&entered, &rays, &meets}; }
};

/// How much a log holds; also the denominators of bytes per ray and steps per ray.
struct LogTotals {
  std::uint64_t rays[ray_kinds] = {};
  std::uint64_t branches = 0;
  std::uint64_t transforms = 0;
  std::uint64_t leaves = 0;
  std::uint64_t tests = 0;
  std::uint64_t lookups = 0;  ///< of mailboxes; 0 without mailboxes
  std::uint64_t shades = 0;
  std::uint64_t lights = 0;
  std::uint64_t texels = 0;
  std::uint64_t any_hits = 0;
  std::uint64_t cuts = 0;
  std::uint64_t passes = 0;
  std::uint64_t visits_95 = 0;    ///< the least number of visits that 95 % of the rays do not exceed
  std::uint64_t most_visits = 0;  ///< of a ray: branches, instances, leaves and nodes taken as one voxel
  std::uint64_t bytes = 0;        ///< words and pixel offsets

  [[nodiscard]] std::uint64_t all_rays() const {
    return std::accumulate(std::begin(rays), std::end(rays), std::uint64_t{0});
  }
  /// Number of steps that the log records: visits, tests, rays, shades, lights, texels, cuts, passes
  /// and questions whether a hit counts.
  [[nodiscard]] std::uint64_t all_steps() const {
    return all_rays() + branches + transforms + leaves + tests + shades + lights + texels + cuts + passes +
           any_hits;
  }
};

/// What a log says of its frame and of the database, with the tree that its steps refer to.
struct LogFacts {
  accel::Traversal traversal = accel::Traversal::octree;   ///< the walk that made it
  Integrator integrator = Integrator::whitted;             ///< the program that made it
  accel::WalkOrder order = accel::WalkOrder::depth_first;  ///< in which rays took nodes
  std::uint32_t treelet_records = 0;  ///< with WalkOrder::treelet_first: the most node records of a treelet
  bool mailboxes = false;             ///< for each entry of a leaf's list, its mailbox was looked up
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t samples = 1;  ///< camera rays of a pixel; each pixel that is logged has all of them
  accel::Topology topology;
  std::uint32_t primitives = 0;  ///< number of primitive records in the database
  /// Kinds of the primitives behind the triangles: those with the ids from primitives - quadrics.size() on.
  std::vector<accel::PrimitiveKind> quadrics;
  /// Number of material records, averaged ones included. With Integrator::gaussians these are the records of
  /// the Gaussians, one after the other (scenes/gaussians.h).
  std::uint32_t materials = 0;
  std::uint32_t voxels = 0;  ///< of these, averaged for the voxel cut: the last ones
  /// Number of lights; with asks_emitters() and emissive triangles these are together one light more, the
  /// last.
  std::uint32_t lights = 0;
  std::vector<std::uint64_t> texture_begin;  ///< first texel of each texture in the texel array, plus the end
};

/// A whole frame's log. Immutable once recorded; shared read-only by replays.
struct WorkLog : LogFacts {
  std::vector<LogRow> rows;  ///< `height` of them, from the top

  /// Whether it has words beside the steps.
  [[nodiscard]] bool has(RowWords LogRow::*beside) const {
    return !rows.empty() && !(rows.front().*beside).begin.empty();
  }
  [[nodiscard]] bool has_entered() const { return has(&LogRow::entered); }
  [[nodiscard]] bool has_ray_words() const { return has(&LogRow::rays); }
  [[nodiscard]] bool has_meets() const { return has(&LogRow::meets); }
  /// An accel::EnteredChildren for each branch that the pixel's rays visit, in their order; has_entered().
  [[nodiscard]] std::span<const std::uint32_t> entered(std::uint32_t x, std::uint32_t y) const {
    return rows[y].entered.pixel(x);
  }
  /// A word for each of the pixel's rays, in their order; has_ray_words().
  [[nodiscard]] std::span<const std::uint32_t> ray_words(std::uint32_t x, std::uint32_t y) const {
    return rows[y].rays.pixel(x);
  }
  /// What each of the pixel's rays meets, in their order; has_meets().
  [[nodiscard]] std::span<const std::uint32_t> meets(std::uint32_t x, std::uint32_t y) const {
    return rows[y].meets.pixel(x);
  }
  [[nodiscard]] std::uint32_t triangles() const {
    return primitives - static_cast<std::uint32_t>(quadrics.size());
  }
  [[nodiscard]] accel::PrimitiveKind kind_of(std::uint32_t primitive) const {
    return primitive < triangles() ? accel::PrimitiveKind::triangle : quadrics[primitive - triangles()];
  }
  [[nodiscard]] std::span<const std::uint32_t> pixel(std::uint32_t x, std::uint32_t y) const {
    return rows[y].pixel(x);
  }
};

/// Throws UserError when a database with that many records does not fit the operands of a log.
void check_log_capacity(std::size_t nodes, std::size_t materials, std::size_t lights, std::size_t textures);

/// Counts the whole log in one pass; with `shades`, also the shaded points of each material.
[[nodiscard]] LogTotals totals_of(const WorkLog& log, std::vector<std::uint64_t>* shades = nullptr);

}  // namespace marti::processors::program
