// Scenes made by a recipe: the Standard Procedural Databases of E. Haines (A Proposal for Standard
// Graphics Environments, IEEE CG&A 7(11), 1987; recipes and colours of SPD 3.14), with their cameras,
// lights, materials and background, and one composed from them. docs/scenes.md describes each.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "scenes/file_options.h"
#include "scenes/scene.h"
#include "sim/memory_budget.h"

namespace marti::scenes {

/// The part of a name after the size, as `pot` in "teapot:12:pot".
struct ProceduralVariant {
  std::string_view name;
  std::string_view meaning;
};

struct ProceduralScene {
  std::string_view name;
  std::uint32_t minimum_size;
  std::uint32_t maximum_size;
  std::uint32_t default_size;
  std::string_view meaning;  ///< what the scene shows, and the effect of the size n
  std::span<const ProceduralVariant> variants;
  std::uint64_t (*primitives)(std::uint64_t n);  ///< how many there are at size n, without a variant
};

/// Every procedural scene, in alphabetical order.
[[nodiscard]] std::span<const ProceduralScene> procedural_scenes();

/// Makes the scene of `spec` = name[:size[:variant]], for example "teapot", "gears:4", "teapot:12:pot". The
/// same spec gives the same bytes. Throws UserError for an unknown name or variant (naming the nearest valid
/// one), for a size that is not a whole number or out of range, and KeyError when the scene takes more than
/// `memory`. `instances`: whether Gaussians' proxies are kept; that of none of the other scenes is.
[[nodiscard]] Scene make_procedural(std::string_view spec, const sim::MemoryBudget& memory = {},
                                    Instances instances = Instances::copied);

}  // namespace marti::scenes
