#include "sim/chunks.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "sim/large_pages.h"

namespace marti::sim {

// The beginning of a piece.
struct alignas(std::max_align_t) Chunks::Piece {
  std::atomic<std::size_t> users = 1;  // tables in it, and the object that hands it out
};

namespace {

constexpr std::size_t unit = alignof(std::max_align_t);
constexpr std::size_t smallest_piece = std::size_t{64} << 10U;
constexpr std::size_t largest_piece = std::size_t{8} << 20U;
constexpr std::size_t large_page = std::size_t{2} << 20U;

std::atomic<std::size_t> pieces = 0;

// Size of the next piece, when so many bytes have been taken.
std::size_t next_size(std::size_t taken) {
  const std::size_t next = std::clamp(taken / 4, smallest_piece, largest_piece);
  return next < large_page / 4 ? next : (next + large_page - 1) / large_page * large_page;
}

// What stands before each table.
struct alignas(unit) Label {
  void* piece;
};

}  // namespace

Chunks::Chunks(Chunks&& other) noexcept
    : piece_(std::exchange(other.piece_, nullptr)),
      used_(std::exchange(other.used_, 0)),
      size_(std::exchange(other.size_, 0)),
      taken_(std::exchange(other.taken_, 0)) {}

Chunks::~Chunks() { leave(piece_); }

Chunks::Piece* Chunks::new_piece(std::size_t bytes) {
  Piece* const piece = new (LargePageAllocator<std::byte>().allocate(bytes)) Piece;
  ++pieces;
  return piece;
}

void Chunks::leave(Piece* piece) {
  if (piece != nullptr && piece->users.fetch_sub(1) == 1) {
    piece->~Piece();
    LargePageAllocator<std::byte>().deallocate(reinterpret_cast<std::byte*>(piece), 0);
    --pieces;
  }
}

void* Chunks::table_at(Piece* piece, std::size_t at) {
  return new (reinterpret_cast<std::byte*>(piece) + at) Label{piece} + 1;
}

void* Chunks::allocate(std::size_t bytes) {
  const std::size_t taken = sizeof(Label) + (bytes + unit - 1) / unit * unit;
  if (piece_ == nullptr || taken > size_ - used_) {
    const std::size_t next = next_size(taken_);
    // A table that would leave much of a piece unused has one of its own.
    if (taken > next / 4) {
      taken_ += taken;
      return allocate_alone(bytes);
    }
    Piece* const piece = new_piece(next);
    leave(std::exchange(piece_, piece));
    used_ = sizeof(Piece);
    size_ = next;
    taken_ += next;
  }
  ++piece_->users;
  void* const table = table_at(piece_, used_);
  used_ += taken;
  return table;
}

void* Chunks::allocate_alone(std::size_t bytes) {
  return table_at(new_piece(sizeof(Piece) + sizeof(Label) + bytes), sizeof(Piece));
}

void Chunks::deallocate(void* table) { leave(static_cast<Piece*>((static_cast<Label*>(table) - 1)->piece)); }

std::size_t Chunks::in_use() { return pieces; }

}  // namespace marti::sim
