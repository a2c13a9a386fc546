#include "scenes/pbrt_transform.h"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/trigonometric.hpp>

#include "scenes/vertex_values.h"

namespace marti::scenes::pbrt {

namespace {

constexpr std::array<std::string_view, 7> statements = {"Identity", "Translate", "Scale",          "Rotate",
                                                        "LookAt",   "Transform", "ConcatTransform"};

glm::dvec3 vector_at(const std::vector<double>& numbers, std::size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

/// pbrt's camera looks along +z, y is up and x to the right.
glm::dmat4 look_at(const glm::dvec3& eye, const glm::dvec3& at, const glm::dvec3& up, const Text& text) {
  const glm::dvec3 forward = unit_or_zero(at - eye);
  const glm::dvec3 right = unit_or_zero(glm::cross(unit_or_zero(up), forward));
  if (right == glm::dvec3(0.0)) {
    text.fail("LookAt needs a point apart from the eye, and an up that is not along the line between them");
  }
  const glm::dvec3 upright = glm::cross(forward, right);
  return glm::affineInverse(glm::dmat4(glm::dvec4(right, 0.0), glm::dvec4(upright, 0.0),
                                       glm::dvec4(forward, 0.0), glm::dvec4(eye, 1.0)));
}

}  // namespace

bool is_transform(std::string_view statement) {
  return std::find(statements.begin(), statements.end(), statement) != statements.end();
}

glm::dmat4 transform_by(const std::string& statement, Text& text, const glm::dmat4& before) {
  const glm::dmat4 identity(1.0);
  if (statement == "Identity") {
    return identity;
  }
  if (statement == "Translate" || statement == "Scale") {
    const glm::dvec3 by = vector_at(text.numbers(3), 0);
    return before * (statement == "Scale" ? glm::scale(identity, by) : glm::translate(identity, by));
  }
  if (statement == "Rotate") {
    const std::vector<double> given = text.numbers(4);
    const glm::dvec3 axis = unit_or_zero(vector_at(given, 1));
    if (axis == glm::dvec3(0.0)) {
      text.fail("Rotate needs an axis that is not 0");
    }
    return before * glm::rotate(identity, glm::radians(given[0]), axis);
  }
  if (statement == "LookAt") {
    const std::vector<double> given = text.numbers(9);
    return before * look_at(vector_at(given, 0), vector_at(given, 3), vector_at(given, 6), text);
  }
  // Sixteen numbers, column by column.
  const std::vector<double> given = text.numbers(16);
  const glm::dmat4 matrix = glm::make_mat4(given.data());
  return statement == "Transform" ? matrix : before * matrix;
}

Placement placement_of(const glm::dmat4& transform, const Text& text) {
  const Placement placement{glm::dmat3(transform), glm::dvec3(transform[3])};
  const glm::dvec4 last(transform[0].w, transform[1].w, transform[2].w, transform[3].w);
  if (last != glm::dvec4(0.0, 0.0, 0.0, 1.0)) {
    text.fail("the transform is not affine: its last row is not 0 0 0 1");
  }
  if (!is_usable(placement.offset) || is_singular(placement.linear)) {
    text.fail("the transform is singular, or moves beyond 1e30");
  }
  return placement;
}

}  // namespace marti::scenes::pbrt
