#include "memory/line_sharing.h"

namespace marti::memory {

void LineSharing::fetch(std::uint32_t node, std::uint32_t line) {
  ++fetches_;
  if (fetched_by_[node].insert(line)) {
    std::vector<std::uint32_t>& users = users_[node / nodes_];
    if (line >= users.size()) {
      users.resize(std::size_t{line} + 1);
    }
    ++users[line];
  }
}

SharingResult LineSharing::result() const {
  SharingResult result;
  result.fetches = fetches_;
  for (const std::vector<std::uint32_t>& users : users_) {
    for (const std::uint32_t nodes : users) {
      if (nodes != 0) {
        ++result.distinct;
        ++result.fetched[nodes];
      }
    }
  }
  return result;
}

}  // namespace marti::memory
