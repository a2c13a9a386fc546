// An entry of the catalogue of figures: what a result says about a machine or a frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sim/statistics.h"
#include "studies/figures/formula.h"

namespace marti::studies::figures {

/// How the figures of nodes, clusters, banks and levels make the machine's.
enum class Merge : std::uint8_t {
  sum,
  largest,
  least,
  one,    ///< there is only one in a machine or frame
  ratio,  ///< computed by the formula from figures that are merged
};
inline constexpr std::array<std::string_view, 5> merge_names = {"sum", "largest", "least", "one", "ratio"};

using Better = sim::Better;
inline constexpr std::array<std::string_view, 4> better_names = {"lower", "higher", "-", "program"};

struct FigureEntry {
  /// A column of the store's table `results` or `frame_results`, or of its view `summary` if it has a
  /// formula; a field of `figures` in result.json. Lower-case letters, digits and '_'.
  std::string name;
  std::string unit;  ///< "1" for a plain number, "fraction" for a part of a whole, else "ps", "byte", ...
  std::string description;
  Merge merge = Merge::sum;
  Better better = Better::lower;
  std::optional<Formula> formula{};  ///< std::nullopt: it is counted, an integer

  /// Not if it says how the program worked: then equal machines may differ in it, and it is not compared.
  [[nodiscard]] bool of_machine() const { return better != Better::program; }
};

}  // namespace marti::studies::figures
