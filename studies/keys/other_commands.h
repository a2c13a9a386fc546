// Which command reads what this one does not.
#pragma once

#include "sim/schema.h"

namespace marti::studies::keys {

/// Names the command that reads each section in which `schema`, whose own keys are all declared, has none: a
/// file is often given to the wrong command.
void declare_sections_of_other_commands(sim::Schema& schema);

}  // namespace marti::studies::keys
