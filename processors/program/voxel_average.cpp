#include "processors/program/voxel_average.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <glm/geometric.hpp>

#include "accel/voxel_cover.h"
#include "scenes/texture.h"
#include "sim/error.h"

namespace marti::processors::program {

namespace {

using Form = accel::SymmetricForm<double>;

// Sums over the surfaces in a cell, each weighted by its area.
struct VoxelSum {
  double area = 0.0;
  Form form{};
  Form shading{};
  glm::dvec3 winding{0.0};
  glm::dvec3 color{0.0};
  glm::dvec3 specular_color{0.0};
  glm::dvec3 emission{0.0};
  double diffuse = 0.0;
  double reflection = 0.0;
  double transmission = 0.0;
  double ior = 0.0;
  double highlight = 0.0;
  double shininess = 0.0;

  void add_normal(Form& into, const glm::dvec3& n, double weight) const {
    const double products[6] = {n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z};
    for (std::size_t k = 0; k < 6; ++k) {
      into[k] += weight * products[k];
    }
  }

  VoxelSum& operator+=(const VoxelSum& other) {
    area += other.area;
    for (std::size_t k = 0; k < 6; ++k) {
      form[k] += other.form[k];
      shading[k] += other.shading[k];
    }
    winding += other.winding;
    color += other.color;
    specular_color += other.specular_color;
    emission += other.emission;
    diffuse += other.diffuse;
    reflection += other.reflection;
    transmission += other.transmission;
    ior += other.ior;
    highlight += other.highlight;
    shininess += other.shininess;
    return *this;
  }
};

using Cell = std::array<std::uint32_t, 3>;

struct Box {
  glm::dvec3 lo;
  glm::dvec3 hi;
};

Box box_of(const scenes::Bounds& root, const Cell& cell, unsigned level) {
  const glm::dvec3 edge = (root.hi - root.lo) * accel::level_scale[level];
  Box box{};
  for (int a = 0; a < 3; ++a) {
    const auto k = static_cast<std::size_t>(a);
    box.lo[a] = root.lo[a] + edge[a] * cell[k];
    box.hi[a] = root.lo[a] + edge[a] * (cell[k] + 1.0);
  }
  return box;
}

// Barycentric weights of a point in the triangle's plane; `normal` is the cross product of two edges.
glm::dvec3 weights_at(const accel::TriangleSet& triangles, std::uint32_t id, const glm::dvec3& point,
                      const glm::dvec3& normal) {
  const glm::dvec3 a = triangles.corner(id, 0);
  const glm::dvec3 b = triangles.corner(id, 1);
  const glm::dvec3 c = triangles.corner(id, 2);
  const double scale = 1.0 / glm::dot(normal, normal);
  const double u = glm::dot(normal, glm::cross(b - point, c - point)) * scale;
  const double v = glm::dot(normal, glm::cross(c - point, a - point)) * scale;
  return {u, v, 1.0 - u - v};
}

// The unit shading normal, on the side of the unit geometric one.
glm::dvec3 shading_normal(const scenes::Scene& scene, std::uint32_t id, const glm::dvec3& weights,
                          const glm::dvec3& geometric) {
  if (scene.normals.empty()) {
    return geometric;
  }
  glm::dvec3 mixed(0.0);
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3& own = scene.normals[scene.triangles[id].vertex[static_cast<std::size_t>(k)]];
    const bool none = own.x == 0.0 && own.y == 0.0 && own.z == 0.0;
    mixed += weights[k] * (none ? geometric : (glm::dot(own, geometric) < 0.0 ? -own : own));
  }
  const double length = glm::length(mixed);
  return length > 0.0 ? mixed / length : geometric;
}

// Adds the part of triangle `id` that lies in the box.
void add_triangle(const scenes::Scene& scene, const accel::TriangleSet& triangles, std::uint32_t id,
                  const Box& box, std::vector<glm::dvec3>& points, VoxelSum& sum) {
  const glm::dvec3 normal = glm::cross(triangles.corner(id, 1) - triangles.corner(id, 0),
                                       triangles.corner(id, 2) - triangles.corner(id, 0));
  const double twice_area = glm::length(normal);
  if (!(twice_area > 0.0) || !std::isfinite(1.0 / glm::dot(normal, normal))) {
    return;
  }
  accel::clip_to_box(triangles[id], box.lo, box.hi, points);
  const glm::dvec3 geometric = normal / twice_area;
  double area = 0.0;
  glm::dvec3 moment(0.0);
  for (std::size_t k = 2; k < points.size(); ++k) {
    const glm::dvec3 a = points[k - 1] - points[0];
    const glm::dvec3 b = points[k] - points[0];
    const double part = 0.5 * glm::dot(geometric, glm::cross(a, b));
    area += part;
    moment += part * (a + b);
  }
  if (!(area > 0.0)) {
    return;
  }
  const glm::dvec3 centroid = points[0] + moment / (3.0 * area);
  const glm::dvec3 weights = weights_at(triangles, id, centroid, normal);
  const scenes::Material& material = scene.materials[scene.triangles[id].material];
  glm::dvec3 color = material.color;
  if (material.texture != scenes::no_texture && !scene.uvs.empty()) {
    const double b[3] = {weights.x, weights.y, weights.z};
    color *= scenes::sample_nearest(scene.textures[material.texture], uv_at(scene, id, b)).color;
  }
  sum.area += area;
  sum.add_normal(sum.form, geometric, area);
  sum.add_normal(sum.shading, shading_normal(scene, id, weights, geometric), area);
  sum.winding += area * geometric;
  sum.color += area * material.diffuse * color;
  sum.specular_color += area * (material.highlight + material.reflection) * material.specular_color;
  sum.emission += area * material.emission;
  sum.diffuse += area * material.diffuse;
  sum.reflection += area * material.reflection;
  sum.transmission += area * material.transmission;
  sum.ior += area * material.transmission * material.ior;
  sum.highlight += area * material.highlight;
  sum.shininess += area * material.highlight * material.shininess;
}

std::array<float, 3> floats(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

AverageVoxel average_of(const VoxelSum& sum, const Cell& cell, unsigned level) {
  AverageVoxel voxel;
  voxel.cell = cell;
  voxel.level = level;
  if (!(sum.area > 0.0)) {
    return voxel;
  }
  const auto mean = [](double total, double weight, double otherwise) {
    return static_cast<float>(weight > 0.0 ? total / weight : otherwise);
  };
  const auto mean_color = [](const glm::dvec3& total, double weight) {
    return floats(weight > 0.0 ? total / weight : glm::dvec3(0.0));
  };
  for (std::size_t k = 0; k < 6; ++k) {
    voxel.shading[k] = static_cast<float>(sum.shading[k] / sum.area);
  }
  voxel.winding = floats(sum.winding / sum.area);
  voxel.color = mean_color(sum.color, sum.diffuse);
  voxel.specular_color = mean_color(sum.specular_color, sum.highlight + sum.reflection);
  voxel.emission = mean_color(sum.emission, sum.area);
  voxel.diffuse = mean(sum.diffuse, sum.area, 0.0);
  voxel.reflection = mean(sum.reflection, sum.area, 0.0);
  voxel.transmission = mean(sum.transmission, sum.area, 0.0);
  voxel.ior = std::max(1.0F, mean(sum.ior, sum.transmission, 1.0));
  voxel.highlight = mean(sum.highlight, sum.area, 0.0);
  voxel.shininess = mean(sum.shininess, sum.highlight, 1.0);
  return voxel;
}

accel::VoxelCover cover_of(const VoxelSum& sum, double longest_edge) {
  accel::VoxelCover cover;
  const double scale = 1.0 / (longest_edge * longest_edge);
  cover.area = static_cast<float>(sum.area * scale);
  for (std::size_t k = 0; k < 6; ++k) {
    cover.form[k] = static_cast<float>(sum.form[k] * scale);
  }
  return cover;
}

// -form * direction as a unit vector; false when it vanishes.
bool facing(const accel::SymmetricForm<float>& form, const Vec3<double>& d, Vec3<double>& normal) {
  const double xx = form[0];
  const double yy = form[1];
  const double zz = form[2];
  const double xy = form[3];
  const double xz = form[4];
  const double yz = form[5];
  const Vec3<double> v(-(xx * d.x + xy * d.y + xz * d.z), -(xy * d.x + yy * d.y + yz * d.z),
                       -(xz * d.x + yz * d.y + zz * d.z));
  const double size = largest(absolute(v));
  if (!(size > 0.0) || !std::isfinite(size)) {
    return false;
  }
  normal = normalized(v * (1.0 / size));
  return dot(normal, d) < 0.0;
}

}  // namespace

scenes::Material AverageVoxel::material() const {
  const auto doubles = [](const std::array<float, 3>& v) { return glm::dvec3(v[0], v[1], v[2]); };
  scenes::Material m;
  m.color = doubles(color);
  m.specular_color = doubles(specular_color);
  m.emission = doubles(emission);
  m.diffuse = diffuse;
  m.reflection = reflection;
  m.transmission = transmission;
  m.ior = ior;
  m.highlight = highlight;
  m.shininess = shininess;
  return m;
}

unsigned first_small_level(const scenes::Bounds& root, const scenes::ImagePlane& plane, double threshold,
                           std::uint32_t max_depth) {
  if (root.empty()) {
    return static_cast<unsigned>(accel::level_scale.size());
  }
  const glm::dvec3 edges = root.hi - root.lo;
  glm::dvec3 farthest(0.0);
  for (int a = 0; a < 3; ++a) {
    farthest[a] = std::max(std::abs(root.lo[a] - plane.origin[a]), std::abs(root.hi[a] - plane.origin[a]));
  }
  const double reach = 1.01 * (glm::length(farthest) + (max_depth - 1.0) * glm::length(edges));
  // The pixel in the middle of the image has the largest solid angle.
  const double pixel = threshold * glm::length(glm::cross(plane.step_x, plane.step_y));
  const double limit = std::max({edges.x, edges.y, edges.z}) / std::sqrt(pixel);
  unsigned level = 1;
  while (level < accel::level_scale.size() && !(reach > limit * accel::level_scale[level])) {
    ++level;
  }
  return level;
}

VoxelAverages VoxelAverages::build(const scenes::Scene& scene, const accel::Octree& octree,
                                   unsigned first_level, unsigned threads) {
  sim::ensure(scene.quadrics.empty(), "voxel averages: spheres, cylinders and cones have none");
  const std::vector<accel::TopologyNode>& nodes = octree.topology().nodes;
  const std::vector<std::uint32_t>& entries = octree.topology().entries;
  VoxelAverages averages;
  averages.root_ = octree.bounds();
  averages.first_level_ = first_level;
  // Nodes are in breadth-first order, so those of a level and of all deeper levels are the last ones.
  const auto first = std::partition_point(
      nodes.begin(), nodes.end(), [&](const accel::TopologyNode& node) { return node.level < first_level; });
  const auto first_node = static_cast<std::uint32_t>(first - nodes.begin());
  std::vector<Cell> cells(nodes.size());
  std::vector<std::uint32_t> node_of;
  averages.voxel_of_.assign(nodes.size() - first_node, accel::no_voxel);
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    if (!nodes[n].leaf) {
      for (std::uint32_t child = 0; child < 8; ++child) {
        cells[nodes[n].first + child] = {2 * cells[n][0] + (child & 1U), 2 * cells[n][1] + (child >> 1U & 1U),
                                         2 * cells[n][2] + (child >> 2U)};
      }
    }
    if (n >= first_node && !(nodes[n].leaf && nodes[n].count == 0)) {
      averages.voxel_of_[n - first_node] = static_cast<std::uint32_t>(node_of.size());
      node_of.push_back(n);
    }
  }

  std::vector<VoxelSum> sums(node_of.size());
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(threads < static_cast<unsigned>(cores) && threads != 0 ? static_cast<int>(threads)
                                                                               : cores);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, node_of.size(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        std::vector<glm::dvec3> points;
                        for (std::size_t v = range.begin(); v < range.end(); ++v) {
                          const accel::TopologyNode& node = nodes[node_of[v]];
                          const Box box = box_of(averages.root_, cells[node_of[v]], node.level);
                          for (std::uint32_t k = 0; node.leaf && k < node.count; ++k) {
                            add_triangle(scene, octree.triangles(), entries[node.first + k], box, points,
                                         sums[v]);
                          }
                        }
                      });
  });
  const glm::dvec3 edges = averages.root_.hi - averages.root_.lo;
  const double longest = std::max({edges.x, edges.y, edges.z});
  // Children have higher numbers than their parents.
  for (std::size_t v = node_of.size(); v-- > 0;) {
    const accel::TopologyNode& node = nodes[node_of[v]];
    for (std::uint32_t child = 0; !node.leaf && child < 8; ++child) {
      const std::uint32_t below = averages.voxel_of_[node.first + child - first_node];
      if (below != accel::no_voxel) {
        sums[v] += sums[below];
      }
    }
    averages.voxels_.push_back(average_of(sums[v], cells[node_of[v]], node.level));
    averages.covers_.push_back(cover_of(sums[v], longest * accel::level_scale[node.level]));
  }
  std::reverse(averages.voxels_.begin(), averages.voxels_.end());
  std::reverse(averages.covers_.begin(), averages.covers_.end());
  averages.table_ = {averages.voxel_of_.data(), averages.covers_.data(), first_node,
                     static_cast<std::uint32_t>(scene.materials.size())};
  return averages;
}

Surface<double> VoxelAverages::surface(std::uint32_t voxel, const Vec3<double>& direction) const {
  const AverageVoxel& average = voxels_[voxel];
  const Box box = box_of(root_, average.cell, average.level);
  Surface<double> surface;
  surface.point = Vec3<double>(0.5 * (box.lo + box.hi));
  surface.error = Vec3<double>(0.5 * (box.hi - box.lo));
  // Above the rounding of the three lines above and of leave(): 2^-40 of the root, as its cells' margin.
  surface.margin =
      0x1p-40 * largest(Vec3<double>(root_.hi - root_.lo)) + 0x1p-48 * largest(absolute(surface.point));
  if (!facing(covers_[voxel].form, direction, surface.geometric)) {
    surface.geometric = -direction;
  }
  if (!facing(average.shading, direction, surface.normal)) {
    surface.normal = surface.geometric;
  }
  surface.color = Vec3<double>(average.material().color);
  const glm::dvec3 winding(average.winding[0], average.winding[1], average.winding[2]);
  surface.outside = !(dot(Vec3<double>(winding), direction) > 0.0);
  return surface;
}

}  // namespace marti::processors::program
