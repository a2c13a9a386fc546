// What the columns of a store mean, and the figures derived from them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace marti::studies::sweep {

struct StoreColumn {
  std::string table;
  std::string name;
  std::string unit;
  std::string description;
  std::string merge{};    ///< of a figure (studies/figures/figure_entry.h): how its parts' values combine
  std::string better{};   ///< of a figure: whether lower or higher is better
  std::string formula{};  ///< of a derived figure
};

/// Every column of every table and view that is not of the host.
[[nodiscard]] std::vector<StoreColumn> store_columns(std::span<const std::string> axes);

/// The SQL that makes the view `summary`: points with what follows from their counters.
[[nodiscard]] std::string summary_view(std::span<const std::string> axes);

/// The SQL that makes the table `intervals` and the view `interval_figures`.
[[nodiscard]] std::string intervals_sql();

}  // namespace marti::studies::sweep
