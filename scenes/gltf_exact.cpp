#include "scenes/gltf_exact.h"

#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>

#include "scenes/gltf_material.h"
#include "sim/error.h"

namespace marti::scenes::gltf {

namespace {

constexpr double largest = 1e30;

bool agree(const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) <= 1e-9 * glm::length(b); }

bool same_view(const Camera& a, const Camera& b) {
  const ImagePlane p = a.image_plane(1, 1);
  const ImagePlane q = b.image_plane(1, 1);
  return agree(p.corner, q.corner) && agree(p.step_x, q.step_x) && agree(p.step_y, q.step_y);
}

}  // namespace

int exact_view(const Model& model, const tinygltf::Value& extras, const char* semantic) {
  const tinygltf::Value* const own = own_extras(extras);
  const int view = own == nullptr ? -1 : index_in(*own, semantic).value_or(-1);
  return static_cast<std::size_t>(view) < model.data().bufferViews.size() ? view : -1;
}

void restore_values(const Model& model, int view, const std::string& user, std::vector<double>& values) {
  if (view < 0) {
    return;
  }
  const std::span<const std::byte> bytes = model.view_bytes(view, user);
  if (bytes.size() != values.size() * sizeof(double)) {
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    double exact = 0.0;
    std::memcpy(&exact, bytes.data() + i * sizeof exact, sizeof exact);
    if (std::abs(exact) <= largest && static_cast<double>(static_cast<float>(exact)) == values[i]) {
      values[i] = exact;
    }
  }
}

void restore_light(const tinygltf::Value& own, Light& light) {
  const auto restore = [&own](const char* key, glm::dvec3& vector) {
    const auto exact = color_in(own, key, -largest, largest);
    vector = exact && agree(*exact, vector) ? *exact : vector;
  };
  restore("color", light.color);
  restore("direction", light.direction);
  const auto restore_cosine = [&own](const char* key, double& cosine) {
    const double exact = number_in(own, key).value_or(cosine);
    cosine = exact <= 1.0 && std::abs(exact - cosine) <= 1e-9 ? exact : cosine;
  };
  restore_cosine("cos_inner_cone", light.cos_inner_cone);
  restore_cosine("cos_outer_cone", light.cos_outer_cone);
}

void restore_camera(const tinygltf::Value& own, Camera& camera) {
  Camera exact = camera;
  exact.at = color_in(own, "at", -largest, largest).value_or(camera.at);
  exact.up = color_in(own, "up", -largest, largest).value_or(camera.up);
  try {
    camera = same_view(exact, camera) ? exact : camera;
  } catch (const sim::UserError&) {
    return;  // these span no view
  }
}

}  // namespace marti::scenes::gltf
