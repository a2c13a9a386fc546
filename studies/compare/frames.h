// Whether two results are of the same frame: only then is a difference of their times one of their machines.
#pragma once

#include <string_view>
#include <vector>

#include "studies/compare/differences.h"

namespace marti::studies::compare {

/// A setting of what is rendered and how ([scene], [frames], [image], [structure]), not of the machine.
[[nodiscard]] bool is_frame_setting(std::string_view key);

/// Whether both rendered the same rays and pixels: the hashes of the image and of all hits, and the size of
/// the image, are equal. Another tree gives the same rays and pixels, so its machines can be compared. Of
/// results that lack a hash, whether the settings of their frames are equal.
[[nodiscard]] bool same_frame(const ComparedResult& a, const ComparedResult& b);

/// Those of the differences that are settings of the frame.
[[nodiscard]] std::vector<Difference> frame_settings(const std::vector<Difference>& settings);

}  // namespace marti::studies::compare
