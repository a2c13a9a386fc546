// The recursive ray tracer (Whitted, CACM 23(6), 1980), one pixel at a time, without recursion: rays wait on
// a small stack with the weight their colour has in the pixel, and every contribution is added to the pixel
// when it is found. The order of additions is fixed, so the image always has the same bits.
//
// Order of execution, and of the log. The samples of a pixel follow one another. For each: a ray and its
// visits; if it hit, the shading of the point, its texel, and for each light the shadow ray with its visits
// and the light's contribution; then all that the reflected ray leads to; then all that the refracted ray
// leads to.
//
// Integrator::path follows one path of light for each sample instead (Kajiya, "The rendering equation",
// SIGGRAPH 1986). Where it meets a surface it asks all lights as above and a point of one emissive triangle,
// and goes on as a scattered, a reflected or a refracted ray, one of them, drawn in proportion to the largest
// colour of each. What triangles emit is added where the eye sees them or their mirror image or refraction;
// elsewhere the asking of a point has added it. From the fourth ray of a path on, a path ends by chance
// ("Russian roulette", Arvo, Kirk, "Particle transport and image synthesis", SIGGRAPH 1990): it goes on with
// a probability that is its largest weight in the sample, at most 1, over which its weight is divided. There
// is no ambient light, and the background shines from everywhere.
//
// Integrator::shadow and Integrator::occlusion send a number of rays from where a camera ray hits, each of
// which any hit ends, and nothing else. With shadow these go to points of the lights, one light after the
// other, the first of them drawn: to points of emissive triangles, and to points of small balls in the place
// of lights without an extent (path_sampling.h). With occlusion they go into the hemisphere about the
// triangle's normal with a density proportional to the cosine, and reach a given distance. The image shows
// the share of them that nothing blocks; one that would begin behind its own surface is not sent and counts
// as blocked.
//
// Integrator::gaussians looks through the scene's Gaussians (accel/nearest_gaussians.h): a ray finds the
// nearest of them, adds their colours from front to back, and goes on behind the last one, until hardly
// anything shines through or it finds fewer than it can hold. Each round is a ray of the log, the first a
// camera ray, all others refraction rays. The background shines through.
//
// Integrator::rays follows no light: a pixel is one of the scene's given rays, and its log the ray and its
// visits. The image shows how far away what it hits is.
//
// Where it differs from Whitted's program: shadows are opaque (whatever lies before the light blocks it,
// glass too); reflection and transmission weights are the material's, no Fresnel term; a refracting body is
// surrounded by vacuum on the side from which its triangles wind counter-clockwise, bodies do not nest.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include <glm/geometric.hpp>

#include "accel/octree_cut.h"
#include "accel/ray.h"
#include "processors/program/gaussian_color.h"
#include "processors/program/path_sampling.h"
#include "processors/program/quadric_surface.h"
#include "processors/program/recorder.h"
#include "processors/program/render.h"
#include "processors/program/sample_points.h"
#include "processors/program/shading.h"
#include "scenes/camera.h"
#include "scenes/scene.h"
#include "scenes/texture.h"
#include "sim/mix.h"

namespace marti::processors::program {

/// A structure whose closest() takes a footprint too and may see a voxel: see voxel_average.h.
template <typename Structure>
concept CutsVoxels = requires(const Structure& structure) {
  structure.averages();
};

/// Structure: a concrete structure of accel with closest<Real>(ray, visitor), occluded<Real>(ray, visitor)
/// and triangles(). Recorder: see recorder.h. Real: double, float to compare with, or accel::Counted to
/// count the operations.
/// A tracer belongs to one host thread.
template <typename Real, typename Structure, typename Recorder>
class Tracer {
 public:
  using Vec = Vec3<Real>;

  /// Keeps references to all but the plane; they must outlive the tracer.
  /// `emitters`: those of the scene with asks_emitters(), else none.
  Tracer(const scenes::Scene& scene, const Structure& structure, const Emitters& emitters,
         const scenes::ImagePlane& plane, const RenderOptions& options, Recorder& recorder)
      : scene_(scene),
        structure_(structure),
        emitters_(emitters),
        plane_(plane),
        options_(options),
        recorder_(recorder),
        left_(options.window ? options.window->left : 0),
        top_(options.window ? options.window->top : 0),
        share_(1.0 / options.samples),
        reach_(largest_side(structure.triangles().bounds())),
        points_(options.samples, options.seed) {
    if (options.integrator == Integrator::gaussians) {
      nearest_.emplace(*scene.gaussians, options.nearest_hits, reach_);
    }
  }

  /// The colour of the frame's pixel (column, row): of the ray through its centre, or the mean of its
  /// samples.
  Vec trace(std::uint32_t column, std::uint32_t row) {
    // All that depends on the pixel depends on its place in the whole image.
    const std::uint32_t x = left_ + column;
    const std::uint32_t y = top_ + row;
    recorder_.begin_pixel();
    color_ = Vec();
    pixel_hash_ = 0;
    depth_of_stack_ = 0;
    if constexpr (CutsVoxels<Structure>) {
      pixel_ = structure_.threshold() * solid_angle(x, y);
    } else if (options_.integrator == Integrator::rays) {
      if (const std::uint64_t ray = given_ray(options_, scene_.rays.rays.size(), column, row);
          ray < scene_.rays.rays.size()) {
        trace_given(ray);
      }
      hit_hash_ += sim::mix(pixel_hash_ ^ (std::uint64_t{y} << 32U | x));
      return color_;
    }
    for (std::uint32_t sample = 0; sample < options_.samples; ++sample) {
      if (options_.integrator != Integrator::whitted) {
        numbers_ = PathNumbers(x, y, sample, options_.seed);
      }
      if constexpr (!CutsVoxels<Structure>) {
        if (nearest_) {
          look_through(points_.at(x, y, sample));
          continue;
        }
      }
      trace(points_.at(x, y, sample));
    }
    hit_hash_ += sim::mix(pixel_hash_ ^ (std::uint64_t{y} << 32U | x));
    recorder_.phase(Phase::pixel, RayKind::camera);
    return color_;
  }

  [[nodiscard]] const RayCounts& rays() const { return rays_; }
  /// Sum over the pixels traced so far; sums of several tracers add up to the frame's.
  [[nodiscard]] std::uint64_t hit_hash() const { return hit_hash_; }
  /// With Integrator::rays, what the ray traced last hits.
  [[nodiscard]] const GivenHit& given_hit() const { return given_hit_; }

 private:
  /// With Integrator::path, the number of the first ray of a path, the eye ray being 1, before which the path
  /// may end by chance.
  static constexpr std::uint32_t first_ray_of_roulette = 4;

  static double largest_side(const scenes::Bounds& box) {
    return box.empty() ? 0.0 : largest(Vec3<double>(box.hi) - Vec3<double>(box.lo));
  }

  struct Pending {
    Vec origin;
    Vec direction;
    Vec weight;
    RayKind kind = RayKind::camera;
    std::uint32_t bounce = 0;
    struct NoPath {};
    [[no_unique_address]] std::conditional_t<CutsVoxels<Structure>, double, NoPath> path{};  ///< from the eye
  };

  /// Traces one camera ray and everything it leads to, with the weight that a sample has in its pixel.
  void trace(const SamplePoint& point) {
    recorder_.phase(Phase::ray, RayKind::camera);
    if constexpr (CutsVoxels<Structure>) {
      path_ = 0.0;
    }
    const auto share = static_cast<Real>(share_);
    const Vec weight(share, share, share);
    push(Vec(plane_.origin), camera_direction(point), weight, RayKind::camera, 0);
    while (depth_of_stack_ > 0) {
      const Pending ray = stack_[--depth_of_stack_];
      follow(ray);
    }
  }

  /// With Integrator::gaussians: one camera ray, in rounds.
  void look_through(const SamplePoint& point) requires(!CutsVoxels<Structure>) {
    RayKind kind = RayKind::camera;
    recorder_.phase(Phase::ray, kind);
    const Vec direction = camera_direction(point);
    accel::Ray ray = make_ray(Vec(plane_.origin), direction);
    nearest_->begin(ray);
    Collected<Real> light;
    for (std::uint32_t round = 0;; ++round) {
      ray.t_min = nearest_->next_round();
      recorder_.ray(kind, round, ray);
      structure_.template nearest<Real>(ray, *nearest_, recorder_);
      ++rays_.traced[static_cast<std::size_t>(kind)];
      rays_.hit[static_cast<std::size_t>(kind)] += nearest_->hits().empty() ? 0U : 1U;
      recorder_.phase(Phase::shade, kind);
      for (const accel::GaussianHit& hit : nearest_->hits()) {
        shade(hit);
        collect(*scene_.gaussians, hit, direction, light);
        if (light.through < Real(least_through)) {
          break;
        }
      }
      if (light.through < Real(least_through) || !nearest_->full()) {
        break;
      }
      kind = RayKind::refraction;
      recorder_.phase(Phase::ray, kind);
    }
    const auto linear = [](const Real& value) {
      return static_cast<Real>(linear_of_screen(static_cast<double>(value)));
    };
    const auto share = static_cast<Real>(share_);
    const Vec weight(share, share, share);
    add(weight, Vec(linear(light.color.x), linear(light.color.y), linear(light.color.z)));
    add(weight, Vec(scene_.background) * light.through);
  }

  /// The records that hold the Gaussian's colour.
  void shade(const accel::GaussianHit& hit) {
    const std::uint32_t first = nearest_->record(hit.gaussian);
    const unsigned degree = scene_.gaussians->degree;
    for (std::uint32_t record = degree == 0 ? 0 : 1; record <= degree; ++record) {
      recorder_.shade(first + record);
    }
    note(hit.gaussian, std::bit_cast<std::uint64_t>(hit.entry));
  }

  /// Traces a given ray. White is what lies at its origin and what blocks one that any hit will do for;
  /// grey, half as bright, what is as far away as the scene's box is long; black, no hit.
  void trace_given(std::uint64_t number) requires(!CutsVoxels<Structure>) {
    const scenes::GivenRay& given = scene_.rays.rays[number];
    const bool any = scene_.rays.wants_any(number);
    const RayKind kind = any ? RayKind::shadow : RayKind::camera;
    recorder_.phase(Phase::ray, kind);
    accel::Ray ray = make_ray(Vec(given.origin), Vec(given.direction));
    ray.t_min = given.least;
    ray.t_max = given.greatest;
    recorder_.ray(kind, 0, ray);
    given_hit_ = {};
    double distance = 0.0;
    if (any) {
      given_hit_.any = structure_.template occluded<Real>(ray, recorder_);
      note(given_hit_.any ? 1U : 0U, 1);
    } else {
      given_hit_.hit = structure_.template closest<Real>(ray, recorder_);
      given_hit_.any = given_hit_.hit.found();
      note(given_hit_.hit.primitive, given_hit_.any ? std::bit_cast<std::uint64_t>(given_hit_.hit.t) : 0);
      distance = given_hit_.any ? given_hit_.hit.t * glm::length(given.direction) : 0.0;
    }
    ++rays_.traced[static_cast<std::size_t>(kind)];
    if (given_hit_.any) {
      ++rays_.hit[static_cast<std::size_t>(kind)];
      const auto grey = static_cast<Real>(distance > 0.0 ? reach_ / (reach_ + distance) : 1.0);
      color_ = Vec(grey, grey, grey);
    }
  }

  Vec camera_direction(const SamplePoint& point) const {
    const auto column = static_cast<Real>(point.column);
    const auto row = static_cast<Real>(point.row);
    return normalized(Vec(plane_.corner) + Vec(plane_.step_x) * column + Vec(plane_.step_y) * row);
  }

  void push(const Vec& origin, const Vec& direction, const Vec& weight, RayKind kind, std::uint32_t bounce) {
    stack_[depth_of_stack_++] = {origin, direction, weight, kind, bounce, {}};
    if constexpr (CutsVoxels<Structure>) {
      stack_[depth_of_stack_ - 1].path = path_;
    }
  }

  /// The solid angle of pixel (x, y) from the eye: the pixel's area over the cube of the distance of its
  /// centre, the image plane being at distance 1.
  double solid_angle(std::uint32_t x, std::uint32_t y) const {
    const Vec3<double> across = cross(Vec3<double>(plane_.step_x), Vec3<double>(plane_.step_y));
    const Vec3<double> center = Vec3<double>(plane_.corner) + Vec3<double>(plane_.step_x) * (x + 0.5) +
                                Vec3<double>(plane_.step_y) * (y + 0.5);
    const double squared = dot(center, center);
    return std::sqrt(dot(across, across)) / (squared * std::sqrt(squared));
  }

  /// A ray that leaves a surface must not hit at t = 0 again. It could where the offset out of the surface is
  /// zero: a triangle in a coordinate plane has points without any error.
  static accel::Ray leaving_ray(const Vec& origin, const Vec& direction) {
    accel::Ray ray = make_ray(origin, direction);
    ray.t_min = static_cast<double>(std::numeric_limits<Held<Real>>::denorm_min());
    return ray;
  }
  static accel::Ray make_ray(const Vec& origin, const Vec& direction) {
    return {{static_cast<double>(origin.x), static_cast<double>(origin.y), static_cast<double>(origin.z)},
            {static_cast<double>(direction.x), static_cast<double>(direction.y),
             static_cast<double>(direction.z)}};
  }

  void follow(const Pending& pending) {
    const auto kind = static_cast<std::size_t>(pending.kind);
    const accel::Ray ray = pending.bounce == 0 ? make_ray(pending.origin, pending.direction)
                                               : leaving_ray(pending.origin, pending.direction);
    recorder_.ray(pending.kind, pending.bounce, ray);
    accel::Hit hit;
    if constexpr (CutsVoxels<Structure>) {
      const accel::CutHit cut =
          structure_.template closest<Real>(ray, {.pixel = pixel_, .path = pending.path}, recorder_);
      if (cut.voxel != accel::no_voxel) {
        see_voxel(pending, cut);
        return;
      }
      hit = cut.hit;
      path_ = pending.path + hit.t;
    } else {
      hit = structure_.template closest<Real>(ray, recorder_);
    }
    ++rays_.traced[kind];
    if (!hit.found()) {
      recorder_.phase(Phase::ray, pending.kind);
      note(accel::no_primitive, 0);
      add(pending.weight, Vec(scene_.background));
      return;
    }
    ++rays_.hit[kind];
    note(hit.primitive, std::bit_cast<std::uint64_t>(hit.t));
    shade(pending, hit);
  }

  void shade(const Pending& pending, const accel::Hit& hit) {
    recorder_.phase(Phase::shade, pending.kind);
    const scenes::HitTriangle at = scenes::hit_triangle(scene_, hit.primitive);
    const std::uint32_t material_id = scenes::material_of(scene_, at.triangle);
    const scenes::Material& material = scene_.materials[material_id];
    recorder_.shade(material_id);
    const Real b[3] = {Real(hit.u), Real(hit.v), Real(hit.w)};
    const bool triangle = at.triangle < scene_.triangles.size();
    Surface<Real> surface =
        triangle ? surface_at(scene_, at, b, pending.direction, reach_)
                 : quadric_surface(structure_.triangles().quadric(hit.primitive),
                                   pending.origin + pending.direction * Real(hit.t), pending.direction);
    if (sends_any_hit_rays(options_.integrator)) {
      ask_any_hit(pending, surface);
      return;
    }
    surface.color = Vec(material.color);
    if (triangle && material.texture != scenes::no_texture && !scene_.uvs.empty()) {
      recorder_.phase(Phase::texel, pending.kind);
      const scenes::TextureSample sample =
          scenes::sample_nearest(scene_.textures[material.texture], uv_at(scene_, at.triangle, b));
      recorder_.texel(material.texture, sample.texel);
      surface.color = surface.color * Vec(sample.color);
      recorder_.phase(Phase::shade, pending.kind);
    }
    light_up(pending, material, surface, emitters_.has(at.triangle));
  }

  /// With sends_any_hit_rays(): all that follows from a camera ray's hit.
  void ask_any_hit(const Pending& pending, const Surface<Real>& surface) {
    const bool occlusion = options_.integrator == Integrator::occlusion;
    std::uint32_t reached = 0;
    for (std::uint32_t ray = 0; ray < options_.secondary_rays; ++ray) {
      reached += (occlusion ? sees_far(surface, ray) : sees_a_light(surface, ray)) ? 1U : 0U;
    }
    const auto share = static_cast<Real>(static_cast<double>(reached) / options_.secondary_rays);
    add(pending.weight, Vec(share, share, share));
  }

  bool sees_far(const Surface<Real>& surface, std::uint32_t number) {
    recorder_.phase(Phase::ray, RayKind::shadow);
    const Vec direction = scattered(surface.geometric, numbers_, number);
    if (!(dot(direction, surface.geometric) > Real(0.0))) {
      return false;
    }
    accel::Ray ray = leaving_ray(leave(surface, direction), direction);
    if (options_.occlusion_distance > 0.0) {
      ray.t_max = options_.occlusion_distance * reach_;
    }
    return !blocked(ray, 1) && reaches(0);
  }

  bool sees_a_light(const Surface<Real>& surface, std::uint32_t number) {
    const std::size_t lights = scene_.lights.size() + (emitters_.empty() ? 0 : 1);
    if (lights == 0) {
      return false;
    }
    recorder_.phase(Phase::ray, RayKind::shadow);
    const auto first = static_cast<std::size_t>(numbers_.at(0, Draw::lobe) * static_cast<double>(lights));
    const std::size_t chosen = (first + number) % lights;
    LightSample<Real> light;
    Vec place;
    if (chosen < scene_.lights.size()) {
      light = light_at(scene_.lights[chosen], surface);
      place = Vec(scene_.lights[chosen].position);
      if (!light.reaches) {
        return false;
      }
      jitter(surface, numbers_, number, light, place);
    } else {
      const EmitterSample<Real> sample = emitter_at<Real>(scene_, structure_.triangles().cut_outs(),
                                                          emitters_, surface, numbers_, number, reach_);
      light = sample.light;
      place = sample.target;
    }
    return light.reaches && faces(surface, light) && !in_shadow(surface, light, place, 1) &&
           reaches(static_cast<std::uint32_t>(chosen));
  }

  /// Notes that a ray has come to its light. True.
  bool reaches(std::uint32_t light) {
    recorder_.phase(Phase::light, RayKind::camera);
    recorder_.light(light);
    return true;
  }

  /// The ray ended at a voxel: its averaged material is shaded on a surface that stands for the cell.
  void see_voxel(const Pending& pending, const accel::CutHit& cut) requires CutsVoxels<Structure> {
    const auto kind = static_cast<std::size_t>(pending.kind);
    ++rays_.traced[kind];
    ++rays_.hit[kind];
    ++rays_.voxels[kind];
    path_ = pending.path + cut.t;
    note(~cut.voxel, std::bit_cast<std::uint64_t>(cut.t));
    recorder_.phase(Phase::shade, pending.kind);
    recorder_.shade(structure_.averages().table().first_record + cut.voxel);
    light_up(pending, structure_.averages()[cut.voxel].material(),
             structure_.averages().surface(cut.voxel, pending.direction), false);
  }

  /// Adds the light that leaves the surface towards the ray's origin, and sends the rays that bring more.
  /// `asked`: points of this primitive are drawn wherever light is scattered (ask_emitter), so that a diffuse
  /// ray that ends here must not add its emission once more.
  void light_up(const Pending& pending, const scenes::Material& material, const Surface<Real>& surface,
                bool asked) {
    const bool path = options_.integrator == Integrator::path;
    if (!path) {
      const Vec ambient = surface.color * Vec(scene_.ambient) * Real(material.diffuse);
      add(pending.weight, Vec(material.emission) + ambient);
    } else if (!asked || pending.kind != RayKind::diffuse) {
      add(pending.weight, Vec(material.emission));
    }
    // For averaged materials a black colour makes no difference: their lights are always looked at.
    if (CutsVoxels<Structure> || options_.unlit_shadows ? asks_lights(material) : shows_light(material)) {
      illuminate(pending, material, surface);
    }
    if (path) {
      go_on(pending, material, surface);
    } else {
      spawn(pending, material, surface);
    }
  }

  void illuminate(const Pending& pending, const scenes::Material& material, const Surface<Real>& surface) {
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
      recorder_.phase(Phase::shade, pending.kind);
      const scenes::Light& light = scene_.lights[i];
      const LightSample<Real> sample = light_at(light, surface);
      if (!sample.reaches || !faces(surface, sample)) {
        continue;
      }
      if (options_.shadows && in_shadow(surface, sample, Vec(light.position), pending.bounce + 1)) {
        continue;
      }
      recorder_.phase(Phase::light, pending.kind);
      recorder_.light(static_cast<std::uint32_t>(i));
      add(pending.weight, lit(material, surface, sample, pending.direction));
    }
    // On a material on which no light shows, lights are asked only with RenderOptions::unlit_shadows, which
    // keeps all shadow rays: also that to an emitter.
    if (!emitters_.empty() && (scatters(material) || !shows_light(material))) {
      ask_emitter(pending, material, surface);
    }
  }

  /// Next-event estimation: the light of one point of one emissive triangle.
  void ask_emitter(const Pending& pending, const scenes::Material& material, const Surface<Real>& surface) {
    recorder_.phase(Phase::shade, pending.kind);
    const EmitterSample<Real> sample = emitter_at<Real>(scene_, structure_.triangles().cut_outs(), emitters_,
                                                        surface, numbers_, pending.bounce, reach_);
    if (!sample.light.reaches || !faces(surface, sample.light) ||
        (options_.shadows && in_shadow(surface, sample.light, sample.target, pending.bounce + 1))) {
      return;
    }
    recorder_.phase(Phase::light, pending.kind);
    recorder_.light(static_cast<std::uint32_t>(scene_.lights.size()));
    add(pending.weight, scattered_share(material, surface, sample.light) * sample.light.radiance);
  }

  /// For a light at a finite distance the ray's direction is not of unit length: t = 1 is the light.
  bool in_shadow(const Surface<Real>& surface, const LightSample<Real>& sample, const Vec& position,
                 std::uint32_t bounce) {
    recorder_.phase(Phase::ray, RayKind::shadow);
    const Vec origin = leave(surface, sample.direction);
    accel::Ray ray;
    if (sample.at_infinity) {
      ray = leaving_ray(origin, sample.direction);
    } else {
      ray = leaving_ray(origin, position - origin);
      ray.t_max = 1.0;
    }
    return blocked(ray, bounce);
  }

  /// Whether anything lies on the ray.
  bool blocked(const accel::Ray& ray, std::uint32_t bounce) {
    recorder_.ray(RayKind::shadow, bounce, ray);
    const bool any = structure_.template occluded<Real>(ray, recorder_);
    constexpr auto kind = static_cast<std::size_t>(RayKind::shadow);
    ++rays_.traced[kind];
    rays_.hit[kind] += any ? 1U : 0U;
    note(any ? 1U : 0U, 1);
    return any;
  }

  /// Pushes the refracted ray on the stack, and the reflected ray on top of it.
  void spawn(const Pending& pending, const scenes::Material& material, const Surface<Real>& surface) {
    if (pending.bounce + 2 > options_.max_depth) {
      return;  // the new ray would be number bounce + 2, the eye ray being 1
    }
    Vec mirror_weight = Vec(material.specular_color) * Real(material.reflection);
    if (material.transmission > 0.0) {
      recorder_.phase(Phase::ray, RayKind::refraction);
      const auto ratio = static_cast<Real>(surface.outside ? 1.0 / material.ior : material.ior);
      Vec direction;
      const Vec weight(Real(material.transmission), Real(material.transmission), Real(material.transmission));
      if (refracted(surface, pending.direction, ratio, direction)) {
        send(pending, surface, direction, weight, RayKind::refraction);
      } else {
        mirror_weight = mirror_weight + weight;  // total internal reflection
      }
    }
    recorder_.phase(Phase::ray, RayKind::reflection);
    if (mirror_weight.x > 0.0 || mirror_weight.y > 0.0 || mirror_weight.z > 0.0) {
      send(pending, surface, reflected(surface, pending.direction), mirror_weight, RayKind::reflection);
    }
  }

  /// With Integrator::path: sends one ray, or ends the path.
  void go_on(const Pending& pending, const scenes::Material& material, const Surface<Real>& surface) {
    if (pending.bounce + 2 > options_.max_depth) {
      return;
    }
    recorder_.phase(Phase::shade, pending.kind);
    const Vec scattered_weight = surface.color * Real(material.diffuse);
    const Vec mirror_weight = Vec(material.specular_color) * Real(material.reflection);
    const auto through = static_cast<Real>(material.transmission);
    const Real scattering = largest(scattered_weight);
    const Real mirroring = largest(mirror_weight);
    const Real sum = scattering + mirroring + through;
    if (!(sum > Real(0.0))) {
      return;
    }
    const Real lobe = drawn<Real>(numbers_.at(pending.bounce, Draw::lobe)) * sum;
    RayKind kind = RayKind::diffuse;
    Vec factor = scattered_weight;
    Real chance = scattering;
    if (!(lobe < scattering)) {
      const bool mirrored = lobe < scattering + mirroring || !(through > Real(0.0));
      kind = mirrored ? RayKind::reflection : RayKind::refraction;
      factor = mirrored ? mirror_weight : Vec(through, through, through);
      chance = mirrored ? mirroring : through;
    }
    factor = factor * (sum / chance);
    if (pending.bounce + 2 >= first_ray_of_roulette) {
      const Real survival = largest(pending.weight * factor) * Real(options_.samples);
      if (survival < Real(1.0)) {
        if (!(drawn<Real>(numbers_.at(pending.bounce, Draw::roulette)) < survival)) {
          return;
        }
        factor = factor * (Real(1.0) / survival);
      }
    }
    recorder_.phase(Phase::ray, kind);
    Vec direction;
    if (kind == RayKind::diffuse) {
      direction = scattered(surface.normal, numbers_, pending.bounce);
      if (!(dot(direction, surface.geometric) > Real(0.0))) {
        return;  // into the surface: a smooth normal leans away from the triangle's own
      }
    } else if (kind == RayKind::reflection ||
               !refracted(surface, pending.direction,
                          static_cast<Real>(surface.outside ? 1.0 / material.ior : material.ior),
                          direction)) {
      kind = RayKind::reflection;
      recorder_.phase(Phase::ray, kind);
      direction = reflected(surface, pending.direction);
    }
    send(pending, surface, direction, factor, kind);
  }

  void send(const Pending& pending, const Surface<Real>& surface, const Vec& direction, const Vec& factor,
            RayKind kind) {
    const Vec weight = pending.weight * factor;
    const Real size = largest(weight);
    if (!(size > Real(0.0)) || size < Real(options_.min_weight * share_)) {
      return;
    }
    if constexpr (std::is_same_v<Real, float>) {
      // The squares of the triangle's edges do not fit floats, so its normal is not finite.
      if (!std::isfinite(direction.x + direction.y + direction.z)) {
        return;
      }
    }
    // Rounding would let the length drift over many bounces.
    push(leave(surface, direction), normalized(direction), weight, kind, pending.bounce + 1);
  }

  void add(const Vec& weight, const Vec& light) { color_ = color_ + weight * light; }

  void note(std::uint32_t primitive, std::uint64_t t_bits) {
    pixel_hash_ = sim::mix((pixel_hash_ ^ t_bits) * 0x9e3779b97f4a7c15U + primitive);
  }

  const scenes::Scene& scene_;
  const Structure& structure_;
  const Emitters& emitters_;
  scenes::ImagePlane plane_;
  RenderOptions options_;
  Recorder& recorder_;
  std::uint32_t left_;  ///< of the frame in its image
  std::uint32_t top_;
  double share_;  ///< weight of a sample in its pixel
  double reach_;  ///< largest side of the scene's box
  SamplePoints points_;
  PathNumbers numbers_{0, 0, 0, 0};  ///< of the sample, unless with Integrator::whitted

  Vec color_;
  RayCounts rays_;
  std::uint64_t hit_hash_ = 0;
  std::uint64_t pixel_hash_ = 0;
  GivenHit given_hit_;                              ///< with Integrator::rays
  std::optional<accel::NearestGaussians> nearest_;  ///< with Integrator::gaussians
  double pixel_ = 0.0;  ///< with the voxel cut: solid angle below which a cell is taken whole
  double path_ = 0.0;   ///< with the voxel cut: from the eye to where new rays start
  /// Each ray taken off puts at most two on, once per level.
  std::array<Pending, max_ray_depth + 1> stack_;
  std::size_t depth_of_stack_ = 0;
};

}  // namespace marti::processors::program
