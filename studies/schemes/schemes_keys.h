// The configuration of `marti study schemes`: what is traced, and which machines are timed from it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::schemes {

/// A machine of a file of its own, with so many nodes.
struct NamedMachine {
  std::string name;  ///< of the file, without directory and .toml; other than a-z and 0-9 is a '_'
  processors::machine::MachineConfig config;
};

/// A structure by the name that the configuration gives it.
struct NamedStructure {
  std::string name;
  std::string kind;  ///< accel::structure_kinds
  accel::BvhNodeKind node = accel::BvhNodeKind::eight;
};

struct SchemesConfig {
  keys::FrameConfig frame;
  std::vector<std::filesystem::path> machines;  ///< files of machines whose scaling is compared
  std::vector<std::uint32_t> nodes;             ///< ascending, each once
  std::filesystem::path cell_machine;           ///< whose misses are counted over cells and structures
  std::vector<NamedStructure> structures;       ///< compared on it; may be empty
  std::vector<std::uint32_t> cell_levels;       ///< ascending, each once; may be empty
  std::uint32_t cell_objects = 1;
  std::filesystem::path stage_machine;  ///< a pipeline, or empty
  std::uint32_t stage_nodes = 16;       ///< of all its stages
};

/// Nodes of a cluster that a machine cannot do without.
[[nodiscard]] constexpr std::uint32_t fewest_nodes(const processors::machine::MachineConfig& machine) {
  return machine.scheme == processors::machine::Scheme::pipeline ? processors::machine::pipeline_stages : 1;
}

void declare_schemes_keys(sim::Schema& schema);

/// The schema of `marti study schemes`: the keys of what is traced, and a section of its own.
[[nodiscard]] sim::Schema schemes_schema();

/// Throws UserError naming file, line and key; the machines are read with one of the node counts each, so
/// that a wrong one is found before anything runs.
[[nodiscard]] SchemesConfig read_schemes(sim::Config& config);

/// The machine of a file, for logs of the frame: what the file says about scene, image and structure is read
/// and left aside, but node records are as large as those of the frame's structure. Throws UserError.
[[nodiscard]] NamedMachine read_machine_file(const std::filesystem::path& file,
                                             const keys::FrameConfig& frame);

/// The same with so many nodes in each cluster. A pipeline's are shared out among its stages in
/// the proportions of `shares`, each stage at least one; it needs as many nodes as stages.
[[nodiscard]] NamedMachine read_machine_file(const std::filesystem::path& file,
                                             const keys::FrameConfig& frame, std::uint32_t nodes,
                                             const processors::machine::PipelineConfig& shares);

}  // namespace marti::studies::schemes
