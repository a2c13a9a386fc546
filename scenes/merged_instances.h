// Internal to scenes/: the instances of several scenes as those of one.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/scene.h"

namespace marti::scenes {

/// How many triangles, the first ones, are where their vertices are: all of a scene without instances, else
/// those of the first mesh if it stands nowhere but in the first instance and is not moved by it.
[[nodiscard]] std::uint32_t fixed_triangles(const Scene& scene);

/// Makes one mesh, in one instance that does not move it, of all triangles of a scene without instances, if
/// it has any: meshes that are kept can follow.
void begin_instances(Scene& scene);

/// A note that counts the instances, if there are any.
void note_instances(Scene& scene);

/// Collects kept meshes and where they stand while a scene grows, whose own triangles must come first.
class MergedInstances {
 public:
  /// Appends a part as append_geometry() does; of one with instances those triangles that are where their
  /// vertices are. Its kept meshes and instances are left to finish().
  void append(Scene& to, Scene& part, std::uint32_t first_material);

  /// Puts the meshes behind the scene's own triangles, and numbers all instances. Curved primitives become
  /// triangles then. Without instances the scene is not changed. Throws UserError as number_instances() does.
  void finish(Scene& scene);

  [[nodiscard]] bool empty() const { return instances_.empty(); }

 private:
  std::vector<Triangle> triangles_;
  std::vector<PrimitiveRange> meshes_;  // of triangles_
  std::vector<InstancePlace> instances_;
};

}  // namespace marti::scenes
