// A project of its own that links every component: scene, structure, image.
#include <cstdio>

#include "accel/structure.h"
#include "accel/triangles.h"
#include "memory/cache.h"
#include "processors/program/render.h"
#include "scenes/procedural.h"

int main() {
  const marti::scenes::Scene scene = marti::scenes::make_procedural("tetra:2");
  const auto triangles = std::make_shared<const marti::accel::TriangleSet>(scene);
  const auto structure = marti::accel::make_structure("octree", triangles);
  marti::processors::program::RenderOptions options;
  options.width = 16;
  options.height = 16;
  const marti::processors::program::Frame frame =
      marti::processors::program::render(scene, *triangles, *structure, options, 1);
  const marti::memory::Cache cache(marti::memory::CacheConfig{});
  std::printf("%u triangles, %llu rays, %llu lines\n", triangles->size(),
              static_cast<unsigned long long>(frame.rays.all()),
              static_cast<unsigned long long>(cache.shape().lines()));
  return triangles->size() == 16 && frame.rays.traced[0] == 256 && frame.rays.hit[0] > 0 ? 0 : 1;
}
