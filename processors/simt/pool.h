// Objects that come and go, known by numbers.
#pragma once

#include <cstdint>
#include <vector>

namespace marti::processors::simt {

/// A number is taken again when its object has been given back; objects keep what they have allocated.
template <class T>
class Pool {
 public:
  std::uint32_t take() {
    if (free_.empty()) {
      objects_.emplace_back();
      return static_cast<std::uint32_t>(objects_.size() - 1);
    }
    const std::uint32_t number = free_.back();
    free_.pop_back();
    return number;
  }
  void give_back(std::uint32_t number) { free_.push_back(number); }
  T& operator[](std::uint32_t number) { return objects_[number]; }

 private:
  std::vector<T> objects_;
  std::vector<std::uint32_t> free_;
};

}  // namespace marti::processors::simt
