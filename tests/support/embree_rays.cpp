#include "tests/support/embree_rays.h"

#include <embree3/rtcore.h>

#include <cstddef>
#include <cstdint>
#include <memory>

#include "sim/error.h"

namespace marti::tests {

namespace {

RTCRay their_ray(const scenes::GivenRay& given) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(given.origin.x);
  ray.org_y = static_cast<float>(given.origin.y);
  ray.org_z = static_cast<float>(given.origin.z);
  ray.tnear = static_cast<float>(given.least);
  ray.dir_x = static_cast<float>(given.direction.x);
  ray.dir_y = static_cast<float>(given.direction.y);
  ray.dir_z = static_cast<float>(given.direction.z);
  ray.tfar = static_cast<float>(given.greatest);
  ray.mask = 0xffffffffU;
  return ray;
}

}  // namespace

std::vector<accel::Hit> embree_hits(const scenes::Scene& scene) {
  const std::unique_ptr<RTCDeviceTy, void (*)(RTCDevice)> device(rtcNewDevice("threads=1"), rtcReleaseDevice);
  sim::ensure(device != nullptr, "Embree gives no device");
  const std::unique_ptr<RTCSceneTy, void (*)(RTCScene)> theirs(rtcNewScene(device.get()), rtcReleaseScene);
  rtcSetSceneFlags(theirs.get(), RTC_SCENE_FLAG_ROBUST);
  const std::unique_ptr<RTCGeometryTy, void (*)(RTCGeometry)> mesh(
      rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE), rtcReleaseGeometry);
  auto* position = static_cast<float*>(rtcSetNewGeometryBuffer(
      mesh.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), scene.positions.size()));
  for (const glm::dvec3& p : scene.positions) {
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      *position++ = static_cast<float>(p[axis]);
    }
  }
  auto* corner = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      mesh.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), scene.triangles.size()));
  for (const scenes::Triangle& triangle : scene.triangles) {
    for (const std::uint32_t vertex : triangle.vertex) {
      *corner++ = vertex;
    }
  }
  rtcCommitGeometry(mesh.get());
  rtcAttachGeometry(theirs.get(), mesh.get());
  rtcCommitScene(theirs.get());
  sim::ensure(rtcGetDeviceError(device.get()) == RTC_ERROR_NONE, "Embree takes no such scene");

  std::vector<accel::Hit> hits;
  for (std::size_t i = 0; i < scene.rays.rays.size(); ++i) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit found{};
    found.ray = their_ray(scene.rays.rays[i]);
    found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    accel::Hit& hit = hits.emplace_back();
    if (scene.rays.wants_any(i)) {
      rtcOccluded1(theirs.get(), &context, &found.ray);
      hit.primitive = found.ray.tfar < 0.0F ? 0 : accel::no_primitive;
    } else {
      rtcIntersect1(theirs.get(), &context, &found);
      if (found.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
        const double u = static_cast<double>(found.hit.u);
        const double v = static_cast<double>(found.hit.v);
        hit = {static_cast<double>(found.ray.tfar), found.hit.primID, 1.0 - u - v, u, v};
      }
    }
  }
  return hits;
}

}  // namespace marti::tests
