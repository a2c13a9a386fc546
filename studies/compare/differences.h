// What differs between two results: their settings, their figures, and whether they rendered the same frame.
#pragma once

#include <optional>
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

  [[nodiscard]] bool is_one_sided() const { return a == tables::Cell() || b == tables::Cell(); }
  /// |b - a| / max(|a|, |b|), 0 to 2: how much it differs. Of two numbers only.
  [[nodiscard]] std::optional<double> relative() const;
};

struct Differences {
  std::vector<Difference> settings;  ///< by name
  /// By rank(), then by name.
  std::vector<Difference> figures;
  std::vector<Difference> equal;  ///< figures, by name
};

[[nodiscard]] Differences differences_of(const ComparedResult& a, const ComparedResult& b);

/// Differences are sorted by it, descending: texts, then numbers by relative(), then what only one side has.
[[nodiscard]] double rank(const Difference& difference);

/// The change from a to b for people: "+12.50 %"; "from 0" where a is 0.
[[nodiscard]] std::string change_of(const Difference& difference);

/// A setting's value as people write it, a text without the quotation marks that it has in a TOML file; "-"
/// where the machine does not use the setting.
[[nodiscard]] std::string setting_text(const tables::Cell& value);

/// A setting that has a number: a size in bytes, a frequency in Hz and so on.
[[nodiscard]] std::optional<double> setting_number(const std::string& key, const tables::Cell& value);

/// A setting of what is rendered and how ([scene], [frames], [image], [structure]), not of the machine.
[[nodiscard]] bool is_frame_setting(std::string_view key);

/// Whether both rendered the same rays and pixels: the hashes of the image and of all hits, and the size of
/// the image, are equal. Another tree gives the same rays and pixels, so its machines can be compared.
[[nodiscard]] bool same_frame(const ComparedResult& a, const ComparedResult& b);

}  // namespace marti::studies::compare
