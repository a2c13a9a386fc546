// A list of files, folders and recipes as one scene, each where a transform puts it.
//
// The list is TOML in one line, as sim::print_in_line() (sim/document.h) prints what a configuration has:
//
//   ['hall/', {source = 'chair.obj', scale = 0.5, rotate = [0, 90, 0], translate = [2, 0, 1]}]
//
// or one such table alone. `scale` (one factor, or three), `rotate` (degrees about x, then y, then z) and
// `translate` work in this order, whatever theirs in the table; in their place `matrix` has the 12 or 16
// numbers of a matrix for columns of coordinates, row by row.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/animated.h"
#include "scenes/open.h"
#include "scenes/placement.h"

namespace marti::scenes {

struct ListedScene {
  std::string source;  ///< as open_animated() takes it, but no list
  std::optional<Placement> placement;
  std::string name;  ///< for messages: "entry 2, chair.obj"
};

/// Whether the text of a scene's source is a list: it begins with a bracket or a brace.
[[nodiscard]] bool is_scene_list(std::string_view spec);

/// The entries, at least one. Throws UserError, with the number of the entry (from 1), for what is no such
/// list, for more than most_parts entries, for numbers that are not finite or beyond 1e30 and for a
/// transform that is singular.
[[nodiscard]] std::vector<ListedScene> read_scene_list(std::string_view spec);

/// The same list, whose files are named from `directory` where they are not from the root.
[[nodiscard]] std::string scene_list_from(std::string_view spec, const std::filesystem::path& directory);

/// "chair.obj and 3 more": the list in few words.
[[nodiscard]] std::string name_of_scene_list(std::string_view spec);

/// Opens all entries as MergedScene says; relative names are those in `options.base_directory`. Throws
/// UserError as read_scene_list() and the readers do.
[[nodiscard]] AnimatedScene open_scene_list(std::string_view spec, const OpenOptions& options,
                                            const ImageDecoder& decode);

}  // namespace marti::scenes
