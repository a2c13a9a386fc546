// The node with the least load among many, the lowest number on ties, in constant time for small loads.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace marti::processors::flow {

/// Nodes 0 to nodes - 1 in the order of their loads. A node without room is left out.
///
/// The nodes with the same load are a set of bits; further layers of bits above it say which words are not
/// zero. All sets lie in one array.
class LoadOrder {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  /// All nodes begin with a load of 0.
  explicit LoadOrder(std::uint32_t nodes) : load_(nodes, none) {
    std::uint32_t words = nodes;
    do {
      words = (words + 63U) / 64U;
      layers_.push_back(words_of_set_);
      words_of_set_ += words;
    } while (words > 1);
    for (std::uint32_t node = 0; node < nodes; ++node) {
      set(node, 0);
    }
  }

  /// Sets the load of a node; `none` means that the node has no room.
  void set(std::uint32_t node, std::uint32_t load) {
    const std::uint32_t before = load_[node];
    if (load == before) {
      return;
    }
    load_[node] = load;
    if (words_of_set_ == 1) [[likely]] {
      set_in_words(before, load, std::uint64_t{1} << node);
      return;
    }
    if (before != none) {
      erase(bits_.data() + std::size_t{before} * words_of_set_, node);
    }
    if (load == none) {
      return;
    }
    reach(load);
    insert(bits_.data() + std::size_t{load} * words_of_set_, node);
  }

  /// The node with the least load; `none` when no node has room.
  [[nodiscard]] std::uint32_t least() {
    // The last word of a set is its top layer.
    while (least_ < loads_ && bits_[(std::size_t{least_} + 1) * words_of_set_ - 1] == 0) {
      ++least_;
    }
    if (least_ == loads_) {
      return none;
    }
    if (words_of_set_ == 1) [[likely]] {
      return static_cast<std::uint32_t>(std::countr_zero(bits_[least_]));
    }
    const std::uint64_t* const set = bits_.data() + std::size_t{least_} * words_of_set_;
    std::uint32_t at = 0;
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
      at = at * 64U + static_cast<std::uint32_t>(std::countr_zero(set[*layer + at]));
    }
    return at;
  }

 private:
  // Makes sets for loads up to `load`, and lets least() begin at `load` if that is lower.
  void reach(std::uint32_t load) {
    if (load >= loads_) [[unlikely]] {
      make_sets(load + 1);
    }
    least_ = load < least_ ? load : least_;
  }
  // Not inlined: it is called rarely, and its caller then needs no registers for it.
  [[gnu::noinline]] void make_sets(std::uint32_t loads) {
    loads_ = loads;
    bits_.resize(std::size_t{loads} * words_of_set_);
  }
  // Moves a node from one set to another where each set is a word.
  void set_in_words(std::uint32_t before, std::uint32_t load, std::uint64_t node) {
    if (before != none) [[likely]] {
      bits_[before] &= ~node;
    }
    if (load != none) [[likely]] {
      reach(load);
      bits_[load] |= node;
    }
  }
  void insert(std::uint64_t* set, std::uint32_t number) const {
    for (const std::uint32_t layer : layers_) {
      std::uint64_t& word = set[layer + number / 64U];
      const bool was_empty = word == 0;
      word |= std::uint64_t{1} << (number % 64U);
      if (!was_empty) {
        return;
      }
      number /= 64U;
    }
  }
  void erase(std::uint64_t* set, std::uint32_t number) const {
    for (const std::uint32_t layer : layers_) {
      std::uint64_t& word = set[layer + number / 64U];
      word &= ~(std::uint64_t{1} << (number % 64U));
      if (word != 0) {
        return;
      }
      number /= 64U;
    }
  }

  std::uint32_t least_ = 0;  // all sets below it are empty
  std::uint32_t loads_ = 0;  // number of sets
  std::uint32_t words_of_set_ = 0;
  std::vector<std::uint32_t> layers_;  // first word of each layer in a set
  std::vector<std::uint32_t> load_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace marti::processors::flow
