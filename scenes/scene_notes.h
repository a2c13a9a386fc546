// Internal to scenes/: what a reader leaves out of a file or replaces, and the notes about it.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "scenes/scene.h"

namespace marti::scenes {

/// What a reader leaves out or replaces, with counts.
struct LeftOut {
  bool strict = false;                            ///< FileOptions::strict
  std::map<std::string, std::uint64_t> features;  ///< left out, by a description in the plural
  std::map<std::string, std::uint64_t>
      replaced;  ///< by a description in the plural and of what stands for it

  std::map<std::string, std::string> first;  ///< of some features, by the same description: the first one

  /// Counts one thing that is left out, and keeps the name of the first.
  void leave_out(const std::string& what, const std::string& name);
  /// Counts one thing that is replaced. If that is not wanted, throws UserError(`refusal`).
  void replace(const std::string& what, const std::string& refusal);
};

/// A note for each feature and each kind replaced with a count above 0.
void note_left_out(const LeftOut& left_out, Scene& scene);

/// A note that `count` of all polygons, in this `kind` of file "triangles" or "polygons", are left out
/// because of their positions, if there are any.
void note_bad_positions(std::uint64_t count, const char* kind, Scene& scene);

/// A note that counts the triangles without area, if there are any.
void note_degenerate(Scene& scene);

}  // namespace marti::scenes
