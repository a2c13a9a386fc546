// A list made of another one, element by element.
#pragma once

#include <functional>
#include <ranges>
#include <type_traits>
#include <utility>
#include <vector>

namespace marti::sim {

/// What `make`, a function or a member, gives for each element, in order.
template <std::ranges::input_range Range, class Make>
[[nodiscard]] auto mapped(Range&& range, Make make) {
  using Made = std::invoke_result_t<Make&, std::ranges::range_reference_t<Range>>;
  std::vector<std::remove_cvref_t<Made>> all;
  if constexpr (std::ranges::sized_range<Range>) {
    all.reserve(std::ranges::size(range));
  }
  for (auto&& element : range) {
    all.push_back(std::invoke(make, std::forward<decltype(element)>(element)));
  }
  return all;
}

}  // namespace marti::sim
