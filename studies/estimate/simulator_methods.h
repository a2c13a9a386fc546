// The cheaper methods and their knobs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "studies/estimate/simulator_figures.h"
#include "studies/estimate/simulator_interpolation.h"

namespace marti::studies::estimate {

/// Changes whenever a method answers differently or the list below is another: measured errors
/// (measured_errors.h) are those of one version.
inline constexpr int methods_version = 5;

enum class MethodKind : std::uint8_t {
  exact,         ///< replay of everything
  sampled,       ///< a sample of packets, of which alone the frame is traced (simulator_sample.h)
  analytic,      ///< one pass and mean values (simulator_analytic.h)
  interpolated,  ///< between machines timed exactly (simulator_interpolation.h)
};

struct Method {
  MethodKind kind = MethodKind::exact;
  std::uint64_t strata = 0;        ///< sampled
  std::uint32_t walked_nodes = 0;  ///< analytic
  bool all_caches = false;         ///< analytic: one pass for all sizes of caches
  bool over_caches = false;        ///< interpolated: over sizes of caches, else over numbers of nodes
  Curve curve = Curve::linear;     ///< interpolated

  [[nodiscard]] std::string name() const;  ///< "sampled"
  [[nodiscard]] std::string knob() const;  ///< "16 windows"
};

/// All of them, the exact one first.
[[nodiscard]] std::span<const Method> simulator_methods();

/// Whether the method answers for a machine alone and from the log of the whole frame: not by interpolation,
/// nor for many caches at once, nor from a sample.
[[nodiscard]] constexpr bool answers_alone(const Method& method) {
  return method.kind != MethodKind::interpolated && method.kind != MethodKind::sampled && !method.all_caches;
}

/// The estimate for one machine, without the speed-up, by a method that answers alone. Throws UserError for a
/// machine that the method cannot answer for.
[[nodiscard]] Estimate estimate(const Method& method, const processors::program::WorkLog& log,
                                const processors::machine::MachineConfig& machine);

/// Throws UserError with the reason when a method cannot answer for the machine.
void check_method(const Method& method, const processors::machine::MachineConfig& machine);

}  // namespace marti::studies::estimate
