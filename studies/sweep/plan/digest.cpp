#include "studies/sweep/plan/digest.h"

#include <fmt/format.h>

namespace marti::studies::sweep {

std::string Digest::hex() const { return fmt::format("{:016x}{:016x}", high(), low()); }

}  // namespace marti::studies::sweep
