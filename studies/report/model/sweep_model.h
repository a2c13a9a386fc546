// The analytic model of a whole sweep: for every numeric axis a curve through each line of points that differ
// in that axis only, with the error that was measured by leaving points out.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/report/model/line_model.h"
#include "studies/report/model/report_points.h"

namespace marti::studies::report {

/// Samples of the model along a line; std::nullopt where it does not reach.
struct ModelCurve {
  std::vector<std::optional<Modelled>> samples;  ///< one for each of AxisModel::x
  std::optional<double> saturation;              ///< nodes of a cluster, on an axis of nodes
};

struct AxisModel {
  std::size_t axis = 0;
  std::vector<double> x;  ///< ascending: the axis' values, some between them, and one step beyond either end
  ModelError end[2];      ///< by Zone
  ModelError speed_up[2];
  std::map<std::string, ModelCurve> curves;  ///< by line_key()
  [[nodiscard]] bool has_band(Zone zone) const { return end[static_cast<std::size_t>(zone)].is_known(); }
};

/// The point's place on all axes but one, which is "*": "0,*,2".
[[nodiscard]] std::string line_key(const ReportPoint& point, std::size_t axis);

/// For people: what the curve is worth. `model` may be null: there is no curve.
[[nodiscard]] std::string error_note(const AxisModel* model);

/// What the model takes from a point's counters.
[[nodiscard]] PointCounters counters_of(const ReportPoint& point, double x);

/// One for each numeric axis that has a line of three points or more. Axes are left out, the last first, when
/// all curves together have more than `most_samples`.
[[nodiscard]] std::vector<AxisModel> model_sweep(const ReportPoints& sweep,
                                                 std::size_t most_samples = 60'000);

}  // namespace marti::studies::report
