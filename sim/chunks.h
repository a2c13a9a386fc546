// An allocator for many tables of some kilobytes that are written once and live together: the rows of a log.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace marti::sim {

/// Memory that is taken in pieces and handed out from front to back. The first piece is small, and each
/// further one is a quarter of all before; from half a megabyte on, pieces are whole large pages of 2 MiB,
/// which cost few page faults. So at most about a fifth and 2 MiB are not handed out. A piece is freed when
/// nobody uses a table in it any more and the object is gone or has come to its next piece. One object is for
/// one thread; tables may be freed by any.
class Chunks {
 public:
  Chunks() = default;
  ~Chunks();
  Chunks(const Chunks&) = delete;
  Chunks& operator=(const Chunks&) = delete;
  Chunks(Chunks&& other) noexcept;
  Chunks& operator=(Chunks&&) = delete;

  /// Memory for a table, aligned for every type. Throws std::bad_alloc.
  void* allocate(std::size_t bytes);
  /// Memory for a table with a piece of its own.
  static void* allocate_alone(std::size_t bytes);
  static void deallocate(void* table);
  /// Number of pieces that are in use in the whole program.
  static std::size_t in_use();

 private:
  struct Piece;
  static Piece* new_piece(std::size_t bytes);
  static void leave(Piece* piece);
  static void* table_at(Piece* piece, std::size_t at);

  Piece* piece_ = nullptr;
  std::size_t used_ = 0;   // of the piece
  std::size_t size_ = 0;   // of the piece
  std::size_t taken_ = 0;  // by all pieces
};

/// The allocator of a table. One that is made without Chunks gives each table memory of its own. A copy of a
/// table does not use the Chunks of its original.
template <class T>
class ChunkAllocator {
 public:
  using value_type = T;
  static_assert(alignof(T) <= alignof(std::max_align_t));

  ChunkAllocator() = default;
  explicit ChunkAllocator(Chunks& chunks) : chunks_(&chunks) {}
  template <class U>
  explicit ChunkAllocator(const ChunkAllocator<U>& /*other*/) {}

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) {
      throw std::bad_alloc();
    }
    const std::size_t bytes = count * sizeof(T);
    return static_cast<T*>(chunks_ == nullptr ? Chunks::allocate_alone(bytes) : chunks_->allocate(bytes));
  }
  void deallocate(T* table, std::size_t /*count*/) { Chunks::deallocate(table); }

  [[nodiscard]] ChunkAllocator select_on_container_copy_construction() const { return {}; }
  // Each can free what another has allocated, so a table that is moved keeps its memory, and its new owner
  // its own allocator.
  friend bool operator==(const ChunkAllocator&, const ChunkAllocator&) { return true; }

 private:
  Chunks* chunks_ = nullptr;
};

template <class T>
using ChunkVector = std::vector<T, ChunkAllocator<T>>;

}  // namespace marti::sim
