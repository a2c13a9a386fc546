#include "scenes/scene_notes.h"

#include "scenes/open.h"
#include "sim/error.h"

namespace marti::scenes {

void LeftOut::leave_out(const std::string& what, const std::string& name) {
  ++features[what];
  first.try_emplace(what, name);
}

void LeftOut::replace(const std::string& what, const std::string& refusal) {
  if (strict) {
    throw sim::UserError(refusal);
  }
  ++replaced[what];
}

void note_left_out(const LeftOut& left_out, Scene& scene) {
  for (const auto& [what, count] : left_out.features) {
    if (count > 0) {
      const auto first = left_out.first.find(what);
      scene.notes.push_back("Left out: " + std::to_string(count) + " " + what +
                            (first == left_out.first.end() ? "" : ", the first " + first->second) + ".");
    }
  }
  for (const auto& [what, count] : left_out.replaced) {
    scene.notes.push_back("Replaced: " + std::to_string(count) + " " + what + ".");
  }
}

void note_bad_positions(std::uint64_t count, const char* kind, Scene& scene) {
  if (count > 0) {
    scene.notes.push_back("Left out: " + std::to_string(count) + " of " + std::to_string(scene.polygons) +
                          " " + kind + ", because a position is not finite or beyond 1e30.");
  }
}

void note_degenerate(Scene& scene) {
  const std::uint64_t degenerate = count_degenerate(scene);
  if (degenerate > 0) {
    scene.notes.push_back(
        std::to_string(degenerate) + " of " + std::to_string(scene.triangles.size()) +
        " triangles have no area, or less than numbers of 64 bits can hold; no ray can hit them.");
  }
}

}  // namespace marti::scenes
