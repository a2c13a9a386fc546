// The memory that a structure takes while it is built, checked before its arrays grow.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/memory_budget.h"

namespace marti::accel {

/// Nodes that a builder makes between two checks of the memory.
inline constexpr std::size_t nodes_between_checks = 1024;

/// The most bytes that a vector takes while `more` elements are appended: to grow, it is copied into one
/// twice as large.
template <class Vector>
[[nodiscard]] std::uint64_t growing_bytes(const Vector& vector, std::size_t more) {
  const std::size_t room = vector.capacity();
  const std::size_t needed = vector.size() + more;
  return sizeof(typename Vector::value_type) *
         (needed <= room ? room : room + std::max(2 * vector.size(), needed));
}

/// The bytes that a vector takes.
template <class Vector>
[[nodiscard]] std::uint64_t bytes_of_vector(const Vector& vector) {
  return growing_bytes(vector, 0);
}

/// Throws UserError when `bytes`, which the tree takes so far, exceed the budget. `kind` is the structure's.
inline void require_tree(
    const sim::MemoryBudget& budget, std::uint64_t bytes, std::string_view kind,
    std::string_view remedy = "lower structure.max_level or raise structure.max_objects") {
  budget.require(bytes, "so far the structure (" + std::string(kind) + ") takes", remedy);
}

}  // namespace marti::accel
