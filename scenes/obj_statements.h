// Internal to scenes/: the statements of OBJ files that the reader has no use for.
#pragma once

#include <string_view>

namespace marti::scenes {

/// Whether a statement changes nothing of what is seen: names and groups.
[[nodiscard]] bool is_without_effect(std::string_view statement);

/// What a statement that is left out is for, in the plural, for a note; null when OBJ has no such statement.
[[nodiscard]] const char* left_out_kind(std::string_view statement);

}  // namespace marti::scenes
