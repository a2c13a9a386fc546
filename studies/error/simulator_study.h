// Every method on every machine of the study, beside exact replay.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "studies/error/error_keys.h"
#include "studies/estimate/simulator_figures.h"
#include "studies/estimate/simulator_methods.h"

namespace marti::studies::error {

/// A machine on a frame.
struct ErrorCase {
  std::size_t scene = 0;  ///< index into ErrorConfig::scenes
  std::size_t frame = 0;  ///< a scene in one of ErrorConfig::sides; scene by scene
  std::uint32_t nodes = 1;
  std::uint64_t cache = 0;  ///< bytes
  std::string name;         ///< "teapot:12, 512 x 512, 64 nodes, 16 KiB"
};

/// Accesses to the nodes of one level of a scene's octree beside what the formula of the paper of 1992
/// predicts: A(l+1) = 4 A(l) (B + P) / (B + P + L), every branch being entered into four of its children.
struct LevelAccesses {
  std::string scene;
  std::uint32_t level = 1;
  std::uint64_t accesses = 0;
  double from_above = 0.0;  ///< from the accesses to the level above
  double from_root = 0.0;   ///< from those to the root, level by level
};

struct SimulatorStudy {
  std::vector<ErrorCase> cases;           ///< frame by frame, cache by cache, by ascending nodes
  std::vector<estimate::Estimate> truth;  ///< of each case, by exact replay
  /// [method][case], methods as in simulator_methods(); std::nullopt where a method has no answer.
  std::vector<std::vector<std::optional<estimate::Estimate>>> estimates;
  /// [method][repeat]: processor seconds of runs that answer every case, from the scene to the figures of the
  /// machine and of one node, by interpolation too.
  std::vector<std::vector<double>> cpu_seconds;
  std::vector<LevelAccesses> levels;  ///< of octrees
};

/// Traces each scene and runs everything, measurements of run time interleaved. The same configuration gives
/// the same results, except for cpu_seconds. Throws UserError.
[[nodiscard]] SimulatorStudy study_simulator(const ErrorConfig& config);

}  // namespace marti::studies::error
