// What the page's explorer is made of: the points' figures in columns, and the model's curves.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "studies/report/sweep_answer.h"
#include "studies/report/sweep_model.h"
#include "studies/report/sweep_points.h"

namespace marti::studies {

/// A figure of every point that the page has.
struct ExplorerField {
  std::string name;  ///< as in ReportPoint::figures
  std::string unit;  ///< as shown
  std::string description;
  double scale = 1.0;  ///< shown is the figure times this
  bool exact = false;  ///< all its digits are shown
};

/// The figure as it is shown; std::nullopt where the point lacks it.
[[nodiscard]] std::optional<double> shown(const ExplorerField& field, const ReportPoint& point);

/// The fields that at least one point has.
[[nodiscard]] std::vector<ExplorerField> explorer_fields(const ReportPoints& sweep);

/// "explorer": exact points of the line through `through` along `axis`, the model's curve with its band, and
/// where it extrapolates. The page makes the same rows of explorer_json() (studies/report/page/explorer.js).
/// `model` may be null: points only.
[[nodiscard]] Table explorer_rows(const ReportPoints& sweep, const AxisModel* model, std::size_t axis,
                                  const ReportPoint& through);

/// How an axis stands in a chart: the members of Vega-Lite's channel definition.
[[nodiscard]] nlohmann::ordered_json channel_of(const ReportAxis& axis);

/// See docs/report.md.
[[nodiscard]] nlohmann::ordered_json explorer_json(const ReportPoints& sweep,
                                                   std::span<const AxisModel> models, const Chosen& chosen,
                                                   std::size_t axis);

}  // namespace marti::studies
