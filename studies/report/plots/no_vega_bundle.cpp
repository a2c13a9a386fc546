#include "studies/report/plots/vega_bundle.h"

namespace marti::studies::report {

std::span<const Script> vega_scripts() { return {}; }

bool have_vega_scripts() { return false; }

}  // namespace marti::studies::report
