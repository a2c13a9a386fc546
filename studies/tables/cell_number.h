// A cell's value where it is a number.
#pragma once

#include <optional>

#include "studies/tables/table.h"

namespace marti::studies {

/// An integer or a real as a real; std::nullopt for a text and for a cell without value.
[[nodiscard]] inline std::optional<double> number_of(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return static_cast<double>(*integer);
  }
  const auto* real = std::get_if<double>(&cell);
  return real == nullptr ? std::nullopt : std::optional(*real);
}

}  // namespace marti::studies
