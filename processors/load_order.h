// Which of many nodes has the least load, the lowest number on ties; in constant time for small loads.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace marti::processors {

/// A set of numbers below a fixed bound that knows its least one: bits, and above them bits that say which
/// words are not zero.
class LowestOf {
 public:
  explicit LowestOf(std::uint32_t bound) {
    std::uint32_t words = bound;
    do {
      words = (words + 63U) / 64U;
      layers_.emplace_back(words, 0);
    } while (words > 1);
  }

  void insert(std::uint32_t number) {
    for (auto& layer : layers_) {
      std::uint64_t& word = layer[number / 64U];
      const bool was_empty = word == 0;
      word |= std::uint64_t{1} << (number % 64U);
      if (!was_empty) {
        return;
      }
      number /= 64U;
    }
  }

  void erase(std::uint32_t number) {
    for (auto& layer : layers_) {
      std::uint64_t& word = layer[number / 64U];
      word &= ~(std::uint64_t{1} << (number % 64U));
      if (word != 0) {
        return;
      }
      number /= 64U;
    }
  }

  [[nodiscard]] bool empty() const { return layers_.back()[0] == 0; }

  /// The least number; the set must not be empty.
  [[nodiscard]] std::uint32_t lowest() const {
    std::uint32_t at = 0;
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
      at = at * 64U + static_cast<std::uint32_t>(std::countr_zero((*layer)[at]));
    }
    return at;
  }

 private:
  std::vector<std::vector<std::uint64_t>> layers_;
};

/// Nodes 0 to nodes - 1 in the order of their loads. A node without room is left out.
class LoadOrder {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  /// All nodes begin with a load of 0.
  explicit LoadOrder(std::uint32_t nodes) : nodes_(nodes), load_(nodes, 0) {
    levels_.emplace_back(nodes);
    for (std::uint32_t node = 0; node < nodes; ++node) {
      levels_[0].insert(node);
    }
  }

  /// The node now has this load, or none: no room.
  void set(std::uint32_t node, std::uint32_t load) {
    if (load == load_[node]) {
      return;
    }
    if (load_[node] != none) {
      levels_[load_[node]].erase(node);
    }
    load_[node] = load;
    if (load == none) {
      return;
    }
    while (levels_.size() <= load) {
      levels_.emplace_back(nodes_);
    }
    levels_[load].insert(node);
    least_ = load < least_ ? load : least_;
  }

  /// The node with the least load, or none when no node has room.
  [[nodiscard]] std::uint32_t least() {
    while (least_ < levels_.size() && levels_[least_].empty()) {
      ++least_;
    }
    return least_ < levels_.size() ? levels_[least_].lowest() : none;
  }

 private:
  std::uint32_t nodes_;
  std::uint32_t least_ = 0;  // no level below it has a node
  std::vector<std::uint32_t> load_;
  std::vector<LowestOf> levels_;
};

}  // namespace marti::processors
