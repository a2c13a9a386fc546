// Error against run time of the renderer: what cheaper settings cost the image, and that those which must not
// change it do not.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processors/program/work_log.h"
#include "studies/error/rendering_keys.h"
#include "studies/error/rendering_metrics.h"
#include "studies/error/rendering_settings.h"
#include "studies/tables/study_files.h"

namespace marti::studies::error {

/// A setting, measured.
struct RenderingPoint {
  RenderingSetting setting;
  /// Against the knob's reference. Of several samples the squares are means over the seeds of all repeats
  /// (A. Celarek et al., "Quantifying the error of light transport algorithms", CGF 38(4), 2019), all else is
  /// that of the
  /// first repeat.
  RenderingErrors errors;
  bool below_floor = false;             ///< not above the reference's own noise: the error is not known
  processors::program::LogTotals work;  ///< counted in the first rendering
  std::vector<double> cpu_ms;           ///< processor time of one thread, a figure for each repeat

  [[nodiscard]] std::uint64_t visits() const { return work.branches + work.leaves; }
  /// Rays, visits and tests: what a run time comes from, counted.
  [[nodiscard]] std::uint64_t steps() const { return work.all_rays() + visits() + work.tests; }
};

struct RenderingStudy {
  std::string scene;
  RenderingPlan plan;
  std::uint32_t reference_samples = 0;
  double reference_level = 0.0;  ///< root mean square of the reference of `samples`
  /// Root mean square of that reference's own noise: of the difference of two of them, over sqrt(2).
  double noise_floor = 0.0;
  std::vector<RenderingPoint> points;  ///< in the order of the plan
};

/// Renders everything. Throws InternalError when a setting that must not change the image does, or a
/// rendering is not the same twice; UserError as open_scene and render do, and when a frame would take more
/// than host_machine.memory_limit.
[[nodiscard]] RenderingStudy measure_rendering(const keys::FrameConfig& frame,
                                               const RenderingErrorOptions& options);

/// The family of `marti study error`: tables that are the same always, host tables with run times, text.
[[nodiscard]] tables::StudyOutput output_of(const RenderingStudy& study);

/// Measures, and makes tables and text of it.
[[nodiscard]] tables::StudyOutput rendering_error(const keys::FrameConfig& frame,
                                                  const RenderingErrorOptions& options);

}  // namespace marti::studies::error
