// What a processor's operations cost.
#pragma once

#include <cstdint>

namespace marti::processors::machine {

/// Cycles of one primitive operation. `load` and `store` are the cycles to issue one word; waiting for memory
/// is simulated and not included here.
struct OperationCycles {
  std::int64_t add = 1;
  std::int64_t multiply = 1;
  std::int64_t divide = 1;
  std::int64_t square_root = 1;
  std::int64_t compare = 1;
  std::int64_t integer = 1;
  std::int64_t load = 1;
  std::int64_t store = 1;
};

}  // namespace marti::processors::machine
