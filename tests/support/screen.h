// What a terminal shows.
#pragma once

#include <algorithm>
#include <string>

namespace marti::test {

/// The lines that a terminal shows after this text.
inline std::string screen_after(const std::string& text) {
  std::string screen;
  std::string line;
  std::size_t at = 0;
  for (const char c : text) {
    if (c == '\r') {
      at = 0;
    } else if (c == '\n') {
      screen += line + "\n";
      line.clear();
      at = 0;
    } else {
      line.resize(std::max(line.size(), at + 1), ' ');
      line[at++] = c;
    }
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return screen + line;
}

}  // namespace marti::test
