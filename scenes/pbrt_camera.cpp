#include "scenes/pbrt_camera.h"

#include <array>
#include <cmath>
#include <cstdio>

#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "scenes/pbrt.h"
#include "scenes/text_lines.h"
#include "scenes/vertex_values.h"

namespace marti::scenes::pbrt {

void FilmCamera::set(const std::string& kind, const Placement& to_world, const Parameters& parameters,
                     LeftOut& left_out) {
  if (kind != "perspective") {
    left_out.replace("cameras " + kind.substr(0, 40) + ", by one that sees all of the scene",
                     parameters.place() + ": the camera " + in_quotes(kind) + " is not supported");
    return;
  }
  for (const char* const window : {"screenwindow", "frameaspectratio"}) {
    left_out.features["windows of cameras"] += parameters.find(window) != nullptr ? 1U : 0U;
  }
  view_ = View{to_world, parameters.number("fov", 90.0, 1e-3, 179.9)};
  parameters.leave_out_rest(left_out);
}

void FilmCamera::set_film(const Parameters& parameters) {
  width_ = parameters.number("xresolution", 1280.0, 1.0, 1e9);
  height_ = parameters.number("yresolution", 720.0, 1.0, 1e9);
}

void FilmCamera::use(const std::filesystem::path& file, Scene& scene) const {
  const glm::dmat3& axes = view_->placement.linear;
  Camera& camera = scene.camera;
  camera.eye = view_->placement.offset;
  camera.at = camera.eye + unit_or_zero(axes[2]);
  camera.up = unit_or_zero(axes[1]);
  const double half = std::tan(glm::radians(view_->fov) / 2.0);
  camera.vertical_fov = 2.0 * std::atan(height_ > width_ ? half * height_ / width_ : half);
  // Its x axis is to the right when forward, up and it are right-handed; else the world looks mirrored.
  if (glm::determinant(axes) > 0.0) {
    Placement mirrored;
    mirrored.linear[0][0] = -1.0;
    place(mirrored, file.string(), scene);
    scene.notes.emplace_back(mirrored_note);
  }
  std::array<char, 80> text{};
  static_cast<void>(std::snprintf(text.data(), text.size(),
                                  "Its image is made for a film of %.0f x %.0f pixels.", width_, height_));
  scene.notes.emplace_back(text.data());
}

}  // namespace marti::scenes::pbrt
