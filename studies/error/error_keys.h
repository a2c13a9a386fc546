// The configuration of `marti study error`.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::error {

/// An image of so many times the most samples counts as exact: its own noise adds at most 3 % to the error
/// (sqrt(1 + 1/16)).
inline constexpr std::uint32_t reference_factor = 16;

/// Lists are ascending, each number once; of an empty one nothing is measured.
struct ErrorConfig {
  keys::FrameConfig frame;
  processors::machine::MachineConfig machine;
  std::vector<double> within;           ///< asked of `marti run --within`, shares
  std::vector<std::uint32_t> divisors;  ///< of the sides of smaller images
  std::uint32_t side = 64;              ///< pixels of the longer side of rendered images at most
  std::vector<std::uint32_t> samples;   ///< of a pixel
  std::vector<std::uint32_t> depths;
  std::vector<double> weights;
  std::vector<double> voxel_cuts;
  std::uint32_t repeats = 5;  ///< of every measurement of run time; each draws other samples
};

void declare_error_keys(sim::Schema& schema);

/// The schema of `marti study error`: what is traced, the machine, and a section of its own.
[[nodiscard]] sim::Schema error_schema();

/// Throws UserError naming file, line and key.
[[nodiscard]] ErrorConfig read_error(sim::Config& config);

}  // namespace marti::studies::error
