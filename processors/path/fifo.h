// A queue that takes no memory until something is put into it: there is one for each port of a machine.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace marti::processors::path {

template <class T>
class Fifo {
 public:
  [[nodiscard]] bool empty() const { return first_ == entries_.size(); }
  /// The entries are numbered from the oldest, 0.
  T& operator[](std::size_t number) { return entries_[first_ + number]; }
  T& front() { return entries_[first_]; }
  T& back() { return entries_.back(); }
  void push_back(T entry) { entries_.push_back(std::move(entry)); }
  T pop_front() {
    T entry = std::move(entries_[first_++]);
    // Moving what is left only when as much has been taken out keeps the cost of an entry constant.
    if (2 * first_ >= entries_.size()) {
      entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(first_));
      first_ = 0;
    }
    return entry;
  }

 private:
  std::vector<T> entries_;
  std::size_t first_ = 0;  // the oldest entry that was not taken out
};

}  // namespace marti::processors::path
