// Times as people read them.
#pragma once

#include <string>

#include "sim/time.h"

namespace marti::studies {

/// "1.234 s", "1.234 ms", "1.234 us".
[[nodiscard]] std::string seconds(sim::Ticks ticks);

}  // namespace marti::studies
