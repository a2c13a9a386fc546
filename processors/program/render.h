// Renders a frame: all that the ray-tracing program computes, on all host cores. The result has the same
// bytes at any number of cores.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "accel/ray.h"
#include "accel/walk_order.h"
#include "processors/program/image.h"
#include "processors/program/pixel_set.h"
#include "processors/program/work_log.h"
#include "scenes/scene.h"
#include "sim/work_meter.h"

namespace marti::accel {
class Structure;
class TriangleSet;
}  // namespace marti::accel

namespace marti::processors::program {

/// The most columns, and rows, of an image.
inline constexpr std::uint32_t max_image_side = 32768;

/// The largest RenderOptions::max_depth.
inline constexpr std::uint32_t max_ray_depth = 64;

/// The largest RenderOptions::secondary_rays.
inline constexpr std::uint32_t max_secondary_rays = 4096;

/// The largest RenderOptions::nearest_hits.
inline constexpr std::uint32_t max_nearest_hits = 1024;

/// With Integrator::gaussians a ray ends when no more than this shines through what it has met.
inline constexpr double least_through = 1e-3;
/// It goes on at most this often: each Gaussian that it meets lets 254/255 through at most, so that it has
/// come to its end after 1762 of them.
inline constexpr std::uint32_t most_rounds = 1762;

/// The largest RenderOptions::samples.
inline constexpr std::uint32_t max_samples = 1024;

struct Frame;

/// A frame may be a window of an image: its pixel (0, 0) is then the image's pixel (left, top).
struct Window {
  std::uint32_t image_width = 0;  ///< of the image: at least left + the frame's width, at most max_image_side
  std::uint32_t image_height = 0;  ///< at least top + the frame's height, at most max_image_side
  std::uint32_t left = 0;
  std::uint32_t top = 0;
};

struct RenderOptions {
  std::uint32_t width = 512;   ///< pixels of the frame, 1 to max_image_side
  std::uint32_t height = 512;  ///< pixels of the frame, 1 to max_image_side
  /// If given, each pixel of the frame has the rays, random numbers and colour, bit for bit, of the image's
  /// pixel in its place; else the frame is the whole image.
  std::optional<Window> window = std::nullopt;
  std::uint32_t max_depth =
      5;  ///< rays in a row, the eye ray being 1; 1 to max_ray_depth. Shadow rays are free.
  Integrator integrator = Integrator::whitted;
  /// With sends_any_hit_rays(): of each camera ray that hits, 1 to max_secondary_rays.
  std::uint32_t secondary_rays = 4;
  /// With Integrator::occlusion: how far rays reach, in largest sides of the scene's box; 0: without end. At
  /// least 0 and finite.
  double occlusion_distance = 0.1;
  /// With Integrator::gaussians: how many a ray finds in a round, 1 to max_nearest_hits. The image does not
  /// depend on it.
  std::uint32_t nearest_hits = 16;
  double min_weight = 0.0;  ///< 0 to 1: a ray whose largest weight in its sample is below this is not traced
  /// Camera rays of a pixel, 1 to max_samples, of the same weight. One goes through the pixel's centre,
  /// several through points drawn for them (sample_points.h), whose generator begins with `seed`.
  std::uint32_t samples = 1;
  std::uint64_t seed = 1;
  bool shadows = true;  ///< false: every light that a surface faces reaches it
  /// The voxel cut (accel/octree_cut.h), for an octree only: cells that cover less than this many pixels on
  /// the screen are shaded as one. 0: off, the image is exact. At least 0 and finite.
  double voxel_cut = 0.0;
  /// Also send shadow rays from points where no light can add anything, such as black ones; the image is the
  /// same. With the voxel cut they are always sent.
  bool unlit_shadows = false;
  /// All arithmetic of rays, primitives and colours in floats, to see what that does to the image; the walks
  /// through a structure stay in doubles, with margins as wide as the floats' error. Not with the voxel cut.
  bool floats = false;
  bool mailboxes = false;  ///< no ray tests a primitive twice; the same image
  /// False: with mailboxes, this computer looks none of them up although the log says that it did. Only right
  /// where no ray meets a primitive twice; image and log are the same then.
  bool keep_mailboxes = true;
  /// For a bounding volume hierarchy without mailboxes. The image is that of any order.
  accel::WalkOrder order = accel::WalkOrder::depth_first;
  std::uint32_t treelet_records = 0;  ///< with WalkOrder::treelet_first: the most node records of a treelet
  bool record = false;                ///< also make the work log
  bool hits = false;                  ///< with Integrator::rays: also say what each ray hits
  /// Of a bounding volume hierarchy without mailboxes and walked depth first: the log also has which children
  /// of each branch a ray entered, four bytes a visit.
  bool entered = false;
  /// The log also has for each ray where it begins and where it goes (ray_grid.h), four bytes a ray.
  bool ray_words = false;
  /// Of a bounding volume hierarchy without mailboxes: the log also has what each ray meets
  /// (accel/bvh_meets.h), several times the bytes of its visits.
  bool meets = false;
  /// The pixels that are traced; null for all. The others are those of `before`, or else black and without
  /// words in the log. Must be of the image's size.
  const PixelSet* only = nullptr;
  /// A frame in which other pixels of this image were traced with equal options. The new frame takes over its
  /// colours, log and counts of rays. No pixel of `only` may have been traced in it. Null: nothing is taken
  /// over.
  const Frame* before = nullptr;
  /// Counts each row that is done; after its stop() render() throws sim::Stopped. Null: nobody waits.
  sim::WorkMeter* meter = nullptr;
};

/// With Integrator::rays: which of `rays` rays the pixel (column, row) of the frame stands for, row by row.
/// A frame of fewer pixels has as many of them, evenly spread. `rays` or more: none, in the pixels behind the
/// last.
[[nodiscard]] inline std::uint64_t given_ray(const RenderOptions& options, std::uint64_t rays,
                                             std::uint32_t column, std::uint32_t row) {
  const std::uint64_t pixels = std::uint64_t{options.width} * options.height;
  const std::uint64_t pixel = std::uint64_t{row} * options.width + column;
  return pixels < rays ? pixel * rays / pixels : pixel;
}

/// The plane through which the frame's rays go: that of its whole image.
[[nodiscard]] scenes::ImagePlane image_plane(const scenes::Camera& camera, const RenderOptions& options);

/// Rays of each kind, in the order of RayKind.
struct RayCounts {
  std::array<std::uint64_t, ray_kinds> traced{};
  std::array<std::uint64_t, ray_kinds> hit{};     ///< of these, hit something (a shadow ray: was blocked)
  std::array<std::uint64_t, ray_kinds> voxels{};  ///< of these, saw a voxel; 0 without the voxel cut

  RayCounts& operator+=(const RayCounts& other);
  [[nodiscard]] std::uint64_t all() const {
    return std::accumulate(traced.begin(), traced.end(), std::uint64_t{0});
  }
};

/// What a given ray hits.
struct GivenHit {
  accel::Hit hit;    ///< the closest; of a ray that any hit will do for, empty
  bool any = false;  ///< something is hit
};

struct Frame {
  Image image;
  RayCounts rays;
  /// A hash of the outcome of every ray (pixel of the whole image, order within the pixel, primitive id, bits
  /// of t; for a shadow ray only whether it was blocked). Equal for every structure, machine and number of
  /// threads. It is a sum over the pixels, so that those of windows add up to that of their image.
  std::uint64_t hit_hash = 0;
  std::shared_ptr<const WorkLog> log;  ///< null unless RenderOptions::record
  std::vector<GivenHit> hits;          ///< of each pixel, row by row, with RenderOptions::hits
  std::uint32_t voxels = 0;            ///< averaged materials made for the voxel cut
  unsigned first_voxel_level = 0;      ///< the first level that has them; 0 without any
};

/// Renders `scene`, whose primitives are `triangles` indexed by `structure`, on `threads` host threads (0:
/// all of them). Throws UserError for options out of range; for a voxel cut without an octree, in floats, or
/// of triangles with holes; for path tracing with a voxel cut or a min_weight; for given rays with a voxel
/// cut, several samples or a window, or of a scene that has none; for Gaussians of a scene that has none, or
/// in floats; for what each ray meets (`meets`) of triangles with holes or of Gaussians; and when recording a
/// scene whose nodes, materials, lights or textures do not fit the log's 28-bit operands.
[[nodiscard]] Frame render(const scenes::Scene& scene, const accel::TriangleSet& triangles,
                           const accel::Structure& structure, const RenderOptions& options,
                           unsigned threads = 0);

}  // namespace marti::processors::program
