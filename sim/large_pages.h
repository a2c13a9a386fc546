// Memory for tables that are accessed at random and exceed the reach of the host's TLBs: the system is asked
// for large pages. Where there are none it is ordinary memory. Every array begins a cache line.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
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

/// Copies of many arrays, one behind the other in blocks that are large enough for large pages: each array by
/// itself would get ordinary ones, and the system takes time for every page. What is not used of a block
/// takes no memory on Linux.
template <class T>
class LargeBlocks {
 public:
  /// The copy of an array, which lives as long as the blocks. At most so many arrays of about its size are
  /// yet to come, itself included.
  std::span<const T> copy(std::span<const T> array, std::size_t to_come) {
    if (blocks_.empty() || blocks_.back().capacity() - blocks_.back().size() < array.size()) {
      constexpr std::size_t block = (std::size_t{16} << 20U) / sizeof(T);
      blocks_.emplace_back().reserve(std::max(array.size(), std::min(block, array.size() * to_come)));
    }
    LargeVector<T>& block = blocks_.back();
    block.insert(block.end(), array.begin(), array.end());
    return std::span(block).last(array.size());
  }
  /// Takes the copies of `other`, which stay where they are.
  void merge(LargeBlocks&& other) {
    std::move(other.blocks_.begin(), other.blocks_.end(), std::back_inserter(blocks_));
    other.blocks_.clear();
  }

 private:
  std::vector<LargeVector<T>> blocks_;
};

/// A table of fixed size whose bytes are all 0 at first. What is never accessed takes no memory on Linux,
/// where the system makes pages when they are touched.
template <class T>
class ZeroedTable {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  ZeroedTable() = default;
  explicit ZeroedTable(std::size_t count) : size_(count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) {
      throw std::bad_alloc();
    }
    // calloc gets a large block from the system, whose new pages are 0, and does not clear it again.
    block_.reset(std::calloc(count * sizeof(T) + alignment, 1));
    if (block_ == nullptr) {
      throw std::bad_alloc();
    }
    const std::size_t bytes = count * sizeof(T);
    void* begin = block_.get();
    std::size_t space = bytes + alignment;
    first_ = static_cast<T*>(std::align(alignment, bytes, begin, space));
#ifdef __linux__
    // madvise takes whole pages: the first that begins within the table.
    constexpr std::size_t page = std::size_t{4} << 10U;
    space = bytes;
    if (bytes >= large_page && std::align(page, bytes - page, begin, space) != nullptr) {
      (void)madvise(begin, space, MADV_HUGEPAGE);
    }
#endif
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* data() { return first_; }
  T& operator[](std::size_t at) { return first_[at]; }

 private:
  static constexpr std::size_t large_page = std::size_t{2} << 20U;
  static constexpr std::size_t alignment = 64;  // a cache line
  static_assert(alignof(T) <= alignment);
  struct Free {
    void operator()(void* block) const { std::free(block); }
  };

  std::unique_ptr<void, Free> block_;
  T* first_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace marti::sim
