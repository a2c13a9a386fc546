// Sweeps for tests of the command.
#pragma once

#include <filesystem>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/store_dump.h"

namespace marti::test {

/// Two frames, a dozen machines on each: an instant.
inline const std::string small_sweep = R"([scene]
source = "teapot:2"
[image]
width = 20
height = 20
[costs]
preset = "unit"
[sweep.axes]
image.max_depth = [1, 2]
machine.nodes = [1, 2, 4]
cache.size = ["1 KiB", "4 KiB"]
cache.line = ["16 B", "32 B"]
[prices]
node = 1
cache_kib = 0.25
)";

/// Two frames, hundreds of machines: enough to be caught in the middle.
inline const std::string long_sweep = R"([scene]
source = "teapot:2"
[image]
width = 32
height = 32
[costs]
preset = "unit"
[sweep.axes]
image.max_depth = [1, 2]
machine.nodes = "1..40"
cache.size = ["1 KiB", "2 KiB", "4 KiB", "8 KiB"]
)";

inline Outcome sweep(const std::filesystem::path& config, const std::filesystem::path& directory,
                     const std::string& more = "") {
  return marti("sweep " + quoted(config) + " -o " + quoted(directory) + " --quiet " + more);
}

}  // namespace marti::test
