#include "scenes/pbrt_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/trigonometric.hpp>

#include "scenes/pbrt_color.h"
#include "scenes/text_lines.h"
#include "scenes/vertex_values.h"

namespace marti::scenes::pbrt {

namespace {

constexpr double largest_light = 1e12;

}  // namespace

std::optional<Light> light_source(const std::string& kind, const Parameters& parameters, Scene& scene,
                                  LeftOut& left_out) {
  const double scale = parameters.number("scale", 1.0, 0.0, largest_light);
  if (kind == "infinite") {
    left_out.features["images of infinite lights, which are white skies"] +=
        parameters.find("filename") != nullptr || parameters.find("mapname") != nullptr ? 1U : 0U;
    const glm::dvec3 sky = color_in(parameters, "L", glm::dvec3(1.0), largest_emission, left_out) * scale;
    scene.background = glm::min(scene.background + sky, glm::dvec3(largest_emission));
    scene.ambient = scene.background;
    return std::nullopt;
  }
  Light light;
  const bool distant = kind == "distant";
  light.color = color_in(parameters, distant ? "L" : "I", glm::dvec3(1.0), largest_light, left_out) *
                (scale * std::numbers::inv_pi);
  const glm::dvec3 from = parameters.vector("from", glm::dvec3(0.0));
  const glm::dvec3 to = parameters.vector("to", glm::dvec3(0.0, 0.0, 1.0));
  light.position = from;
  light.direction = unit_or_zero(to - from);
  light.inverse_square = !distant;
  if (distant) {
    light.kind = LightKind::directional;
  } else if (kind == "spot") {
    light.kind = LightKind::spot;
    const double angle = parameters.number("coneangle", 30.0, 0.0, 90.0);
    light.cos_outer_cone = std::cos(glm::radians(angle));
    light.cos_inner_cone =
        std::cos(glm::radians(std::max(0.0, angle - parameters.number("conedeltaangle", 5.0, 0.0, 90.0))));
  } else if (kind == "goniometric" || kind == "projection") {
    left_out.replace("lights " + kind + ", by point lights",
                     parameters.place() + ": lights of the kind " + in_quotes(kind) + " are not supported");
  } else if (kind != "point") {
    parameters.fail("there is no kind of light " + in_quotes(kind));
  }
  if (light.kind != LightKind::point && light.direction == glm::dvec3(0.0)) {
    parameters.fail("the light shines from a point to the same point");
  }
  left_out.features["powers and illuminances of lights"] +=
      parameters.find("power") != nullptr || parameters.find("illuminance") != nullptr ? 1U : 0U;
  return light;
}

}  // namespace marti::scenes::pbrt
