// The plan of a run: what this scene and machine do not need, and what that rests on.
//
// An item is left out only when it is sure that nothing a run reports can differ. Whatever could differ a
// little is not an item of the plan but an approximation, which `marti study error` measures.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace marti::studies::run {

enum class PlanItem : std::uint8_t {
  shadow_rays,
  reflection_rays,
  refraction_rays,
  textures,
  texture_coordinates,
  normals,
  unreachable,
  mailboxes,
  contention,
  cache,
};
inline constexpr std::size_t plan_items = 10;
/// As --keep and reports name them.
inline constexpr std::array<std::string_view, plan_items> plan_item_names = {
    "shadow-rays", "reflection-rays", "refraction-rays", "textures",   "texture-coordinates",
    "normals",     "unreachable",     "mailboxes",       "contention", "cache"};

enum class PlanDecision : std::uint8_t {
  left_out,
  needed,         ///< could not be left out
  kept,           ///< could be left out, but the user wants it kept
  not_applicable  ///< does not occur in this scene or machine
};

inline constexpr std::array<std::string_view, 4> plan_decision_names = {"left out", "needed", "kept",
                                                                        "not applicable"};

struct PlanEntry {
  PlanItem item{};
  PlanDecision decision = PlanDecision::needed;
  std::string fact;  ///< what the decision rests on, for example "0 of 12 materials reflect"
};

/// Items that the user wants kept.
class KeptItems {
 public:
  KeptItems() = default;
  /// `names`: of items, or "all". Throws UserError for another name, with the nearest.
  explicit KeptItems(std::span<const std::string> names);
  static KeptItems all();
  /// All that cannot change the work log.
  static KeptItems all_but_shadow_rays();

  [[nodiscard]] bool has(PlanItem item) const { return bits_[static_cast<std::size_t>(item)]; }
  void keep(PlanItem item) { bits_.set(static_cast<std::size_t>(item)); }

 private:
  std::bitset<plan_items> bits_;
};

struct Plan {
  std::vector<PlanEntry> entries;  ///< at most one for each item, in the order of PlanItem
};

/// Puts entries of items that the plan does not have yet where they belong.
void add_entries(Plan& plan, std::vector<PlanEntry> entries);

[[nodiscard]] inline std::string_view name_of(PlanItem item) {
  return plan_item_names[static_cast<std::size_t>(item)];
}

}  // namespace marti::studies::run
