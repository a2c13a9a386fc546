// Internal to scenes/: the camera of a pbrt file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scenes/pbrt_text.h"
#include "scenes/placement.h"
#include "scenes/scene.h"
#include "scenes/scene_notes.h"

namespace marti::scenes::pbrt {

class FilmCamera {
 public:
  /// The statement Camera. A camera that is not perspective is left out, with a note. Throws UserError when a
  /// parameter is broken or out of range.
  void set(const std::string& kind, const Placement& to_world, const Parameters& parameters,
           LeftOut& left_out);
  /// The statement Film.
  void set_film(const Parameters& parameters);

  /// Whether a perspective camera was set.
  [[nodiscard]] bool given() const { return view_.has_value(); }
  /// Gives it to the scene as this program has cameras: one of the right-handed world. Where its own world
  /// looks mirrored, the scene is mirrored, with mirrored_note.
  void use(const std::filesystem::path& file, Scene& scene) const;

 private:
  struct View {
    Placement placement;  // of the camera in the world
    double fov = 90.0;    // degrees, along the shorter side of the film
  };

  std::optional<View> view_;
  double width_ = 1280.0;  // of the film
  double height_ = 720.0;
};

}  // namespace marti::scenes::pbrt
