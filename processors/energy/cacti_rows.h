// Caches as CACTI gives them.
//
// github.com/HewlettPackard/cacti, commit 1ffd8df (version 7.0.3DD), its cache.cfg with: high-performance
// transistors (itrs-hp) for data and tags, normal access (all ways are read side by side), one bank with one
// port, a bus of one line, no error correction, 360 K, the optimum of energy times delay squared. Lines of 32
// and 64 bytes: 2 KiB to 4 MiB, 1 to 8 ways; of 128 bytes: 8 KiB to 8 MiB, 1 to 32 ways. Caches of fewer than
// 32 sets have no organisation there; of some others no row is at hand.
#pragma once

#include <cstdint>
#include <span>

namespace marti::processors::energy {

struct CactiRow {
  std::uint32_t line = 0;  ///< bytes
  std::uint32_t ways = 0;
  std::uint32_t size = 0;  ///< bytes
  double read = 0.0;       ///< pJ to look a line up and read it
  double write = 0.0;      ///< pJ to bring a line in
  double area = 0.0;       ///< mm2
};

/// In order of line, then ways, then size.
[[nodiscard]] std::span<const CactiRow> cacti_rows_45nm();
[[nodiscard]] std::span<const CactiRow> cacti_rows_22nm();

}  // namespace marti::processors::energy
