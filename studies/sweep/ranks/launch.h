// Whether this process is one of several that mpirun or srun started together.
#pragma once

#include <cstdint>

namespace marti::studies::sweep {

/// How many processes there are, by what the launcher left in the environment; 1 when there was none. That a
/// batch job of Slurm has several tasks does not count: only `srun` starts them.
[[nodiscard]] std::uint32_t launched_processes();

}  // namespace marti::studies::sweep
