#include "studies/show/text_columns.h"

#include <fmt/format.h>

#include "sim/error.h"

namespace marti::studies::show {

std::string TextColumns::row(std::string_view name_of_row, const std::vector<std::string>& cells) const {
  sim::ensure(cells.size() == widths.size(), "a row has not as many cells as its table has columns");
  std::string text = fmt::format("{:<{}}", name_of_row, name);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text += fmt::format("{:>{}}", cells[i], widths[i]);
  }
  return text + "\n";
}

}  // namespace marti::studies::show
