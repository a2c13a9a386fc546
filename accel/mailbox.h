// Mailboxes: each primitive remembers the last ray that tested it, so that a primitive listed in several
// cells is tested once per ray (Arnaldi, Priol, Bouatouch, "A new space subdivision method for ray tracing
// CSG modelled scenes", The Visual Computer 3, 1987; Amanatides and Woo, Eurographics 1987).
//
// Exact: there is one mailbox for each primitive, and ray numbers have 64 bits, so they never repeat. The
// hits are the same with and without. A primitive that a ray has missed would be missed again; one that it
// has hit would not become the best hit twice, because neither its t nor its id is below its own.
//
// The visitor asks for them: a walk with a Mailboxed visitor has them; every other walk has none and does not
// pay for them. A visitor belongs to one thread, and so do its mailboxes.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "accel/counted.h"

namespace marti::accel {

/// Adds mailboxes to a visitor (visitor.h).
template <class Visitor>
class Mailboxed : public Visitor {
 public:
  static constexpr bool has_mailboxes = true;

  using Visitor::Visitor;

  /// Makes room for primitives 0 to `primitives` - 1. Call it before the first ray.
  void prepare(std::uint32_t primitives) {
    if (last_ray_.size() < primitives) {
      last_ray_.resize(primitives, 0);
    }
  }

  /// Begins a new query, for which no primitive is tested yet.
  void next_ray() { ++ray_; }

  /// Looks up the k-th entry of a leaf's list, in order from 0. True when this ray has tested primitive `id`
  /// before; otherwise the caller tests it next.
  bool look_up(std::uint32_t k, std::uint32_t id) {
    if (k % 32 == 0) {
      if (k == 0) {
        tested_.clear();
        left_out_ = false;
      }
      tested_.push_back(0);
    }
    if (last_ray_[id] == ray_) {
      left_out_ = true;
      return true;
    }
    last_ray_[id] = ray_;
    tested_.back() |= 1U << (k % 32);
    return false;
  }

  void leaf(std::uint32_t node, std::uint32_t read, std::uint32_t entries) {
    if (read != 0 && left_out_) {
      Visitor::mailed_leaf(node, read, entries, tested_.data());
    } else {
      Visitor::leaf(node, read, entries);
    }
  }

 private:
  std::vector<std::uint64_t> last_ray_;
  std::uint64_t ray_ = 0;
  std::vector<std::uint32_t> tested_;  ///< for the present leaf, a bit for each entry looked up
  bool left_out_ = false;
};

template <class Visitor>
inline constexpr bool has_mailboxes = requires {
  Visitor::has_mailboxes;
};

/// Every query of every structure calls this first.
template <class Visitor>
inline void begin_query(Visitor& visitor) {
  if constexpr (has_mailboxes<Visitor>) {
    visitor.next_ray();
  }
}

/// Whether the k-th entry of a leaf's list, primitive `id`, has been tested by this ray; never without
/// mailboxes. Counts as one comparison of integers.
template <class Real, class Visitor>
inline bool already_tested(Visitor& visitor, std::uint32_t k, std::uint32_t id) {
  if constexpr (has_mailboxes<Visitor>) {
    if constexpr (std::is_same_v<Real, Counted>) {
      ++operation_counts().integer;
    }
    return visitor.look_up(k, id);
  } else {
    return false;
  }
}

}  // namespace marti::accel
