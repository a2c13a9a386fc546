// The identity of the program's build, so that results kept from another build are recognised.
#pragma once

#include <string_view>

namespace marti::studies::host {

/// "marti VERSION DIGITS"; the digits are a hash of all sources that decide a stored result (the libraries,
/// and those folders of studies/ that read a configuration, run a frame or compute figures; CMakeLists.txt
/// lists them), so that a program that was changed is another one even when its version is the same.
[[nodiscard]] std::string_view build_of_program();

}  // namespace marti::studies::host
