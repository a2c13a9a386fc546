#include "processors/path/path_pieces.h"

#include <utility>

#include "sim/error.h"
#include "sim/key_error.h"

namespace marti::processors {

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
  at(place) = {to, before.pieces_ == nullptr ? none : before.last_, 1, owner, kind};
  return {*this, place, to};
}

std::uint32_t PathPieces::take_place() {
  if (free_ != none) {
    return std::exchange(free_, at(free_).before);
  }
  if (made_ % block == 0) {
    constexpr const char* what = "the pieces of work that may lead to the end of the frame take";
    constexpr const char* remedy = "leave record.critical_path off, or make the image smaller";
    budget_.require((blocks_.size() + 1) * block * sizeof(Kept), what, remedy);
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
    const std::uint32_t before = std::exchange(at(index).before, free_);
    free_ = index;
    index = before;
  }
}

}  // namespace marti::processors
