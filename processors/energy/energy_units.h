// What each thing that is counted takes on one machine, in integers.
#pragma once

#include <array>
#include <cstdint>

#include "processors/machine/machine_config.h"
#include "processors/machine/operation_cycles.h"

namespace marti::processors::energy {

__extension__ using Wide = __int128;

/// The largest energy of an operation, pJ: a step has up to some 100,000 operations, whose sum in aJ must fit
/// 64 bits.
inline constexpr double most_of_operation = 1e5;
/// The largest voltage, as a multiple of the preset's.
inline constexpr double most_voltage = 10.0;

/// An area that depends on the structure that is walked.
inline constexpr Wide by_unit_operations = -1;

/// Of one cache, in aJ.
struct CacheUnits {
  std::int64_t read = 0;
  std::int64_t write = 0;
};

/// Energies in aJ (1e-18 J, a millionth of a pJ) at the machine's voltage, areas in um2, leakage in pW a um2.
struct EnergyUnits {
  machine::OperationCycles operations;  ///< aJ where the cost model has cycles
  machine::OperationCycles
      unit_operations;   ///< aJ of the tests of a ray-tracing unit, where the cost model has cycles
  CacheUnits unit_rays;  ///< of what holds its rays
  std::array<CacheUnits, machine::split_caches> l1;
  CacheUnits l2;
  std::int64_t interconnect_byte = 0;
  std::int64_t hop_byte = 0;
  Wide memory_read = 0;   ///< of one access, with the bytes of a line
  Wide memory_write = 0;  ///< of one access, with the bytes of a line
  Wide dram_activation = 0;
  Wide dram_read = 0;           ///< of one burst
  Wide dram_write = 0;          ///< of one burst
  Wide node_area = 0;           ///< with its caches, without the tests of its ray-tracing unit
  Wide cluster_area = 0;        ///< beside its nodes
  Wide cache_area = 0;          ///< of a node's caches; they are in node_area
  Wide rays_area = 0;           ///< of what holds a unit's rays; it is in node_area
  Wide box_unit_area = 0;       ///< of one; by_unit_operations: that of its operations
  Wide triangle_unit_area = 0;  ///< as before
  std::int64_t leakage = 0;
};

/// Throws KeyError when a figure that the machine needs is not known, or is out of range.
[[nodiscard]] EnergyUnits energy_units(const machine::MachineConfig& config);

}  // namespace marti::processors::energy
