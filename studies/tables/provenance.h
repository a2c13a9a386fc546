// Where results come from, as tables.
#pragma once

#include <span>

#include "sim/config.h"
#include "studies/tables/table.h"

namespace marti::studies::tables {

/// "provenance": the program's version and every setting in use, written as in a TOML file. No date and no
/// path, so that equal runs have equal tables.
[[nodiscard]] Table provenance_table(std::span<const sim::EffectiveValue> values);

/// "host": the computer that ran the study.
[[nodiscard]] Table host_table();

}  // namespace marti::studies::tables
