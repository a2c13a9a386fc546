// What differs between two results: their frames, their settings, and whether they can be compared at all.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studies/compare/figures.h"

namespace marti::studies::compare {

/// A setting or figure; no value where one side has none.
struct Difference {
  std::string name;
  tables::Cell a;
  tables::Cell b;

  /// |b - a| / max(|a|, |b|), 0 to 2: how much it differs. Of two numbers only.
  [[nodiscard]] std::optional<double> relative() const;
};

struct Differences {
  std::vector<Difference> settings;  ///< by name
  std::vector<Difference> numbers;   ///< the largest relative difference first, then by name
  std::vector<Difference> texts;     ///< by name
  std::vector<Difference> one_side;  ///< figures that only one of them has, by name
  std::vector<Difference> equal;     ///< numbers and texts, by name
  std::size_t equal_settings = 0;
};

[[nodiscard]] Differences differences_of(const ComparedResult& a, const ComparedResult& b);

/// The change from a to b for people: "+12.50 %"; "from 0" where a is 0.
[[nodiscard]] std::string change_of(const Difference& difference);

struct SharedDifferences {
  std::vector<Difference> alike;   ///< that every list has, with the same values; by name
  std::vector<Difference> varied;  ///< the others, each as a list has it, if possible one with both values
};

/// Takes the differences that all lists share out of them.
[[nodiscard]] SharedDifferences take_alike(std::span<std::vector<Difference>* const> lists);

/// A setting of what is rendered and how ([scene], [frames], [image], [structure]), not of the machine.
[[nodiscard]] bool is_frame_setting(std::string_view key);

/// Whether both rendered the same rays and pixels: the hashes of the image and of all hits, and the size of
/// the image, are equal. Another tree gives the same rays and pixels, so its machines can be compared. Of
/// results that lack a hash, whether the settings of their frames are equal.
[[nodiscard]] bool same_frame(const ComparedResult& a, const ComparedResult& b);

/// Those of the differences that are settings of the frame.
[[nodiscard]] std::vector<Difference> frame_settings(const std::vector<Difference>& settings);

}  // namespace marti::studies::compare
