// Several texts as one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace marti::sim {

/// "a, b, c".
[[nodiscard]] inline std::string joined(std::span<const std::string> texts, std::string_view between = ", ") {
  std::string all;
  for (const std::string& text : texts) {
    all += (&text == texts.data() ? "" : between);
    all += text;
  }
  return all;
}

/// "a, b and c", as sentences list things; `last` stands before the last of several.
[[nodiscard]] inline std::string listed(std::span<const std::string> texts, std::string_view last = " and ") {
  if (texts.size() < 2) {
    return joined(texts);
  }
  return joined(texts.first(texts.size() - 1)).append(last).append(texts.back());
}

}  // namespace marti::sim
