// What can be made better in a memory of DRAM.
#pragma once

#include <vector>

#include "processors/machine/machine_config.h"
#include "studies/helps/resource.h"

namespace marti::studies::helps {

void add_dram(const Changer& changer, const memory::DramConfig& dram, std::vector<Resource>& resources);

}  // namespace marti::studies::helps
