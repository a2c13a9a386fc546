#include "processors/path/path_pieces.h"

#include <algorithm>
#include <utility>

#include "sim/error.h"
#include "sim/key_error.h"

namespace marti::processors::path {

namespace {

constexpr const char* what = "the pieces of work that may lead to the end of the frame take";
constexpr const char* remedy = "leave record.critical_path off, or make the image smaller";
// Where nothing is folded because a timeline is to show the pieces.
constexpr const char* remedy_of_timelines =
    "leave record.timeline off, for which every piece is kept, or make the image smaller";

}  // namespace

PathTip::PathTip(const PathTip& other) : pieces_(other.pieces_), end_(other.end_), last_(other.last_) {
  if (pieces_ != nullptr) {
    ++pieces_->at(last_).uses;
  }
}

PathTip::PathTip(PathTip&& other) noexcept
    : pieces_(std::exchange(other.pieces_, nullptr)),
      end_(std::exchange(other.end_, 0)),
      last_(other.last_) {}

PathTip& PathTip::operator=(PathTip other) noexcept {
  std::swap(pieces_, other.pieces_);
  std::swap(end_, other.end_);
  std::swap(last_, other.last_);
  return *this;
}

PathTip::~PathTip() {
  if (pieces_ != nullptr) {
    pieces_->leave(last_);
  }
}

PathTip PathPieces::append(const PathTip& before, sim::Ticks length, const PathOwner& owner, PathKind kind) {
  sim::ensure(length >= 0, "a piece of a path that ends before it begins");
  if (length == 0) {
    return before;
  }
  const std::uint32_t place = take_place();
  const sim::Ticks to = sim::add_ticks(before.end(), length);
  if (before.pieces_ != nullptr) {
    ++at(before.last_).uses;
  }
  at(place) = {to, before.pieces_ == nullptr ? none : before.last_, 1, owner, none, kind};
  return {*this, place, to};
}

PathPiece PathPieces::piece_at(std::uint32_t index) const {
  const Kept& piece = at(index);
  return {piece.before == none ? 0 : at(piece.before).to, piece.to, piece.owner, piece.kind};
}

void PathPieces::prepend_to(PathSum& sum, std::uint32_t index, LogLevels& levels) const {
  if (const std::uint32_t folded = at(index).sum; folded != none) {
    sum.prepend(sums_[folded]);
  } else {
    sum.prepend(piece_at(index), levels);
  }
}

PathSum PathPieces::sum_of(const PathTip& tip, LogLevels& levels) const {
  PathSum sum;
  for (std::uint32_t index = tip.pieces_ == nullptr ? none : tip.last_; index != none;
       index = at(index).before) {
    prepend_to(sum, index, levels);
  }
  return sum;
}

void PathPieces::fold() {
  // inner: needed by one piece and by nothing else. Only these are folded, each into the piece behind it, so
  // no tip loses its piece.
  std::vector<bool> inner(made_);
  for (std::uint32_t index = 0; index < made_; ++index) {
    const Kept& piece = at(index);
    if (piece.uses != 0 && piece.before != none && at(piece.before).uses == 1) {
      inner[piece.before] = true;
    }
  }
  const auto is_inner = [&](std::uint32_t index) { return index != none && inner[index]; };
  for (std::uint32_t end = 0; end < made_; ++end) {
    const std::uint32_t last = at(end).before;
    if (at(end).uses == 0 || inner[end] || !is_inner(last) || !is_inner(at(last).before)) {
      continue;
    }
    PathSum sum;
    prepend_to(sum, last, *levels_);
    std::uint32_t before = at(last).before;
    while (is_inner(before)) {
      prepend_to(sum, before, *levels_);
      const std::uint32_t next = at(before).before;
      free_place(before);
      before = next;
    }
    at(last).before = before;
    keep_sum(at(last), std::move(sum));
  }
  fold_at_ = std::max(fold_from_, in_use_ > no_fold / 2 ? no_fold : 2 * in_use_);
}

void PathPieces::keep_sum(Kept& piece, PathSum sum) {
  if (piece.sum == none) {
    if (free_sums_.empty()) {
      sums_.emplace_back();
      free_sums_.reserve(sums_.capacity());
      free_sums_.push_back(static_cast<std::uint32_t>(sums_.size() - 1));
    }
    piece.sum = free_sums_.back();
    free_sums_.pop_back();
  }
  sum_bytes_ = sum_bytes_ + sum.bytes() - sums_[piece.sum].bytes();
  sums_[piece.sum] = std::move(sum);
  require(blocks_.size());
}

void PathPieces::require(std::size_t blocks) const {
  const std::uint64_t of_sums = sum_bytes_ + sums_.capacity() * (sizeof(PathSum) + sizeof(std::uint32_t));
  budget_.require(blocks * block * sizeof(Kept) + of_sums, what,
                  fold_from_ == no_fold ? remedy_of_timelines : remedy);
}

void PathPieces::take(std::uint64_t bytes) {
  budget_.take(bytes, "what leads to the end of the frame takes", "leave record.critical_path off");
}

void PathPieces::free_place(std::uint32_t index) {
  Kept& piece = at(index);
  if (piece.sum != none) {
    sum_bytes_ -= sums_[piece.sum].bytes();
    sums_[piece.sum] = {};
    free_sums_.push_back(piece.sum);
  }
  piece.uses = 0;
  piece.before = std::exchange(free_, index);
  --in_use_;
}

std::uint32_t PathPieces::take_place() {
  if (in_use_ >= fold_at_) {
    fold();
  }
  ++in_use_;
  if (free_ != none) {
    return std::exchange(free_, at(free_).before);
  }
  if (made_ % block == 0) {
    require(blocks_.size() + 1);
    if (made_ == none - block + 1) {
      throw sim::KeyError("record.critical_path",
                          "there are too many pieces of work; make the image smaller");
    }
    blocks_.push_back(std::make_unique<Kept[]>(block));
  }
  return made_++;
}

void PathPieces::leave(std::uint32_t index) {
  while (index != none && --at(index).uses == 0) {
    const std::uint32_t before = at(index).before;
    free_place(index);
    index = before;
  }
}

}  // namespace marti::processors::path
