// Two sweeps, machine by machine.
#pragma once

#include <filesystem>
#include <string>

#include "studies/compare/compare.h"

namespace marti::studies {

/// Machines of the sweeps' present plans are matched by their settings and those of their frames.
[[nodiscard]] std::string compare_sweeps(const std::filesystem::path& a, const std::filesystem::path& b,
                                         const CompareOptions& options);

}  // namespace marti::studies
