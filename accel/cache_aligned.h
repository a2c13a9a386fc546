// Arrays aligned to a cache line.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace marti::accel {

/// An array aligned to a cache line.
template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{64};

  CacheLineAllocator() = default;
  template <class U>
  explicit CacheLineAllocator(const CacheLineAllocator<U>& /*other*/) {}

  [[nodiscard]] T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new(n * sizeof(T), alignment));
  }
  void deallocate(T* p, std::size_t /*n*/) { ::operator delete(p, alignment); }
  bool operator==(const CacheLineAllocator&) const = default;
};
template <class T>
using CacheAligned = std::vector<T, CacheLineAllocator<T>>;

}  // namespace marti::accel
