// What the keys of features do that no machine has together.
#pragma once

#include "sim/config.h"

namespace marti::studies::keys {

/// To be called before the machine is read. Where an assignment (--set) asks for a scheme in which rays move,
/// features of the file that are for packets only get their defaults, as if the assignment had set them too:
/// another scheme is another kind of machine. Throws UserError, at the place of the first one's key, when two
/// features remain that do not combine.
void settle_combinations(sim::Config& config);

}  // namespace marti::studies::keys
