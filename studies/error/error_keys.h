// The configuration of `marti study error`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"
#include "studies/error/rendering_keys.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::error {

/// What is held against exact answers: cheaper ways of timing a machine, cheaper settings of the renderer.
enum class ErrorFamily : std::uint8_t { simulator, rendering };

struct ErrorConfig {
  std::vector<ErrorFamily> families;  ///< at least one, each once
  keys::FrameConfig frame;            ///< of the simulator's family its scene is each of `scenes` in turn
  RenderingErrorOptions rendering;
  std::vector<std::string> scenes;             ///< at least one
  processors::machine::MachineConfig machine;  ///< its nodes and its cache are each of these in turn
  std::vector<std::uint32_t> sides;            ///< of the square images, pixels; ascending, each once
  std::vector<std::uint32_t> nodes;            ///< ascending, each once; the first is 1
  std::vector<std::uint64_t> caches;           ///< bytes of the unified cache; ascending, each once
  std::uint32_t repeats = 3;                   ///< of every measurement of run time
  std::uint64_t seed = 1;                      ///< of the samples
};

void declare_error_keys(sim::Schema& schema);

/// The schema of `marti study error`: what is traced, the machine, and a section of its own.
[[nodiscard]] sim::Schema error_schema();

/// Throws UserError naming file, line and key, also for a machine that a method cannot answer for.
[[nodiscard]] ErrorConfig read_error(sim::Config& config);

/// The machine with so many nodes and a cache of that size. It has as many ways as before, or fewer where the
/// size holds no more lines.
[[nodiscard]] processors::machine::MachineConfig machine_with(
    const processors::machine::MachineConfig& machine, std::uint32_t nodes, std::uint64_t cache_bytes);

}  // namespace marti::studies::error
