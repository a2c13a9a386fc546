#include "scenes/merged_instances.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "scenes/append_geometry.h"
#include "scenes/tessellate.h"

namespace marti::scenes {

std::uint32_t fixed_triangles(const Scene& scene) {
  if (scene.instances.empty()) {
    return static_cast<std::uint32_t>(scene.triangles.size());
  }
  const InstancePlace& first = scene.instances.front();
  const auto stand = std::count_if(scene.instances.begin(), scene.instances.end(),
                                   [](const InstancePlace& place) { return place.mesh == 0; });
  const bool fixed = first.mesh == 0 && first.linear == glm::dmat3(1.0) && first.shift == glm::dvec3(0.0);
  return fixed && stand == 1 ? scene.meshes.front().count : 0;
}

void begin_instances(Scene& scene) {
  if (!scene.triangles.empty()) {
    scene.meshes.push_back({0, static_cast<std::uint32_t>(scene.triangles.size())});
    scene.instances.emplace_back();
  }
}

void note_instances(Scene& scene) {
  if (scene.instances.empty()) {
    return;
  }
  const InstancePlace& last = scene.instances.back();
  scene.notes.push_back("Instances are kept: " + std::to_string(scene.instances.size()) + " of " +
                        std::to_string(scene.meshes.size()) +
                        (scene.meshes.size() == 1 ? " mesh" : " meshes") + " stand for " +
                        std::to_string(last.first + scene.meshes[last.mesh].count) + " triangles.");
}

void MergedInstances::append(Scene& to, Scene& part, std::uint32_t first_material) {
  const std::uint32_t fixed = fixed_triangles(part);
  const std::vector<PrimitiveRange> meshes = std::exchange(part.meshes, {});
  const std::vector<InstancePlace> instances = std::exchange(part.instances, {});
  const std::size_t before = to.triangles.size();
  append_geometry(to, part, first_material);
  if (instances.empty()) {
    return;
  }
  // The first mesh, which is not kept, if some triangles are fixed.
  const std::uint32_t left = fixed > 0 ? 1 : 0;
  const auto first_mesh = static_cast<std::uint32_t>(meshes_.size());
  const auto first_triangle = static_cast<std::uint32_t>(triangles_.size());
  for (std::size_t m = left; m < meshes.size(); ++m) {
    meshes_.push_back({first_triangle + meshes[m].first - fixed, meshes[m].count});
  }
  for (std::size_t i = left; i < instances.size(); ++i) {
    instances_.push_back(instances[i]);
    instances_.back().mesh += first_mesh - left;
  }
  const auto kept = to.triangles.begin() + static_cast<std::ptrdiff_t>(before + fixed);
  triangles_.insert(triangles_.end(), kept, to.triangles.end());
  to.triangles.erase(kept, to.triangles.end());
}

void MergedInstances::finish(Scene& scene) {
  if (instances_.empty()) {
    return;
  }
  if (!scene.quadrics.empty()) {
    scene.notes.push_back("Replaced: " + std::to_string(scene.quadrics.size()) +
                          " spheres, cylinders and cones, by triangles, because instances are kept.");
  }
  tessellate(scene);
  const auto fixed = static_cast<std::uint32_t>(scene.triangles.size());
  begin_instances(scene);
  const auto first_mesh = static_cast<std::uint32_t>(scene.meshes.size());
  for (const PrimitiveRange& mesh : meshes_) {
    scene.meshes.push_back({fixed + mesh.first, mesh.count});
  }
  for (InstancePlace& place : instances_) {
    place.mesh += first_mesh;
  }
  scene.instances.insert(scene.instances.end(), instances_.begin(), instances_.end());
  scene.triangles.insert(scene.triangles.end(), triangles_.begin(), triangles_.end());
  *this = {};
  number_instances(scene);
}

}  // namespace marti::scenes
