// An allocator for tables that are accessed at random and exceed the reach of the host's TLBs: it asks the
// system for large pages. Where there are none it is an ordinary allocator.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace marti::sim {

template <class T>
class LargePageAllocator {
 public:
  using value_type = T;

  LargePageAllocator() = default;
  template <class U>
  explicit LargePageAllocator(const LargePageAllocator<U>& /*other*/) {}

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) {
      throw std::bad_alloc();
    }
    const std::size_t bytes = count * sizeof(T);
    const std::size_t alignment = bytes < page ? small_alignment : page;
    void* memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (memory == nullptr) {
      throw std::bad_alloc();
    }
#ifdef __linux__
    if (bytes >= page) {
      // Advice only: without large pages everything works, only slower.
      (void)madvise(memory, bytes, MADV_HUGEPAGE);
    }
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t /*count*/) { std::free(memory); }

  friend bool operator==(const LargePageAllocator&, const LargePageAllocator&) { return true; }

 private:
  static constexpr std::size_t page = std::size_t{2} << 20U;
  static constexpr std::size_t small_alignment = 64;  // a cache line, and enough for every type
  static_assert(alignof(T) <= small_alignment);
};

template <class T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;

}  // namespace marti::sim
