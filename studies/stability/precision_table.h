// Floats beside doubles: the teapot moved away from the origin.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/precision.h"
#include "studies/tables/table.h"

namespace marti::studies::stability {

/// The teapot moved by `offset` along every axis, and the same rays at it.
struct PrecisionRow {
  double offset = 0.0;
  accel::PrecisionNeed need;
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;          ///< in doubles, at the origin
  std::uint64_t double_agree = 0;  ///< rays with the id that they have at the origin in doubles
  std::uint64_t float_agree = 0;   ///< rays with the same id in floats as in doubles at this place
};

/// At 0, 1e3, 1e6 and 1e9. Half of the rays are aimed at triangles, the others anywhere. Without `floats`
/// nothing is traced in floats, which takes long where all their cells are one.
[[nodiscard]] std::vector<PrecisionRow> compare_precisions(std::uint32_t rays, bool floats = true);

/// "float_double".
[[nodiscard]] tables::Table precision_table(const std::vector<PrecisionRow>& rows);

}  // namespace marti::studies::stability
