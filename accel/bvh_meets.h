// All that a ray meets in a bounding volume hierarchy while no hit shortens it, in words. Whatever else is
// known of hits when a node or primitive comes up, what the ray then visits is found in these words: timing
// uses them where it decides itself in which order, and by which lanes, nodes are visited
// (docs/internals/rt-unit.md, Lanes that help each other).
//
// The first word is the number of words. If the ray meets the root's box, the root follows. A branch is an
// EnteredChildren of those whose boxes are met, then for each of them, the nearest first, two words: its
// rank, and its place, counted from the first word. A leaf is the number of its primitives that are hit, then
// for each of them, in list order, two words: which of the leaf's entries it is, and its rank. Ranks are
// those of distances along the ray: a box whose rank is above that of a hit is left out by the walk because
// of that hit.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "accel/bvh.h"
#include "accel/bvh_order.h"

namespace marti::accel {

/// Real: the scalar in which hits are computed. Not for several threads at a time.
template <class Real>
class BvhMeets {
 public:
  /// Keeps a reference to the tree.
  explicit BvhMeets(const Bvh& bvh) : bvh_(bvh) {}

  /// Adds the ray's words.
  void add(const Ray& ray, std::vector<std::uint32_t>& words) {
    begin_ = words.size();
    distances_.clear();
    words.push_back(0);
    const RaySetup<Real> setup(ray);
    bvh_.with_view([&](const auto& view) {
      return with_boxes(view, ray, setup, Best<Real>(setup), [&](const auto& boxes) {
        add_branch(view, 0, boxes, setup, words);
        return true;
      });
    });
    words[begin_] = static_cast<std::uint32_t>(words.size() - begin_);
    rank(words);
  }

 private:
  template <class Node, class Boxes>
  void add_branch(const BvhView<Node>& view, std::uint32_t record, const Boxes& boxes,
                  const RaySetup<Real>& setup, std::vector<std::uint32_t>& words) {
    std::array<BvhWaiting<typename Boxes::Float>, Node::width> met;
    const std::size_t count = met_children(view, record, boxes, met);
    const std::size_t at = words.size();
    words.resize(at + 1);
    EnteredChildren entered;
    for (std::size_t k = 0; k < count && !boxes.is_behind(met[k].in); ++k) {
      entered.add(met[k].number - view.first_child(record));
      distances_.push_back({static_cast<double>(met[k].in), words.size()});
      words.resize(words.size() + 2);
    }
    words[at] = entered.word();
    for (std::uint32_t k = 0; k < entered.count(); ++k) {
      words[at + 2 + 2 * k] = static_cast<std::uint32_t>(words.size() - begin_);
      if (met[k].child.entries == 0) {
        add_branch(view, met[k].child.record, boxes, setup, words);
      } else {
        add_leaf(view, met[k].child, boxes, setup, words);
      }
    }
  }

  template <class Node, class Boxes>
  void add_leaf(const BvhView<Node>& view, const BvhChild& leaf, const Boxes& boxes,
                const RaySetup<Real>& setup, std::vector<std::uint32_t>& words) {
    const BvhPrimitive* const list = view.primitives + leaf.record;
    const std::size_t at = words.size();
    words.push_back(0);
    for (std::uint32_t k = 0; k < leaf.entries; ++k) {
      Best<Real> best(setup);
      if (test_bvh_primitive(view, list[k], setup, best)) {
        ++words[at];
        words.push_back(k);
        distances_.push_back({static_cast<double>(boxes.limit(best.t)), words.size()});
        words.push_back(0);
      }
    }
  }

  // Puts the rank of each distance into its place.
  void rank(std::vector<std::uint32_t>& words) {
    std::sort(distances_.begin(), distances_.end());
    std::uint32_t rank = 0;
    for (std::size_t i = 0; i < distances_.size(); ++i) {
      rank += i > 0 && distances_[i].first != distances_[i - 1].first ? 1 : 0;
      words[distances_[i].second] = rank;
    }
  }

  const Bvh& bvh_;
  std::size_t begin_ = 0;                                  // of the ray, in its words
  std::vector<std::pair<double, std::size_t>> distances_;  // and the places of their ranks
};

}  // namespace marti::accel
