// Lanes that help each other: the unit finds itself which nodes a ray visits, in what the ray meets, because
// that depends on when which lane finds a hit.
#include "processors/simt/shared_rays.h"

#include <algorithm>
#include <array>
#include <bit>

#include "accel/visitor.h"
#include "processors/simt/simt_node.h"

namespace marti::processors::simt {

// For as many lanes as there are.
void SimtNode::make_room_to_share() {
  shared_lanes_.resize(lanes_.size(), SharedLane(shared_.input.log.order, shared_.order_treelets));
  shared_rays_.resize(lanes_.size());
}

// A lane begins its own ray. False when that visits nothing that has a record.
bool SimtNode::begin_shared(std::uint32_t warp, std::uint32_t number) {
  Lane& its = lane(warp, number);
  LaneWalk::pass_over_visits(its);
  const std::uint32_t* const words = std::exchange(its.meets, its.meets + *its.meets);
  if (words[0] == 1) {
    return false;
  }
  const std::size_t place = place_of(warp, number);
  const bool shadow = program::ray_kind_of(its.ray) == program::RayKind::shadow;
  shared_rays_[place] = {words, shadow, no_hit, 1};
  SharedLane& walk = shared_lanes_[place];
  walk.ray = place;
  walk.best = no_hit;
  walk.visited = 0;
  const SharedEntry root = {1, 0, words + 1};
  walk.waiting.add(&root, 1);
  return next_shared(warp, number);
}

// Takes a lane to the next record of the ray that it works for; what its last one was tested for is known.
bool SimtNode::next_shared(std::uint32_t warp, std::uint32_t number) {
  Lane& its = lane(warp, number);
  SharedLane& walk = shared_lanes_[place_of(warp, number)];
  const SharedRay& ray = shared_rays_[walk.ray];
  const std::vector<accel::TopologyNode>& tree = shared_.input.log.topology.nodes;
  if (std::exchange(walk.tests, false)) {
    if (walk.hits != walk.hits_end && walk.hits[0] == walk.tested) {
      const std::uint32_t rank = ray.shadow ? hit_that_ends : walk.hits[1] + 1;
      walk.hits += 2;
      walk.best = std::min(walk.best, rank);
      found_.push_back({walk.ray, rank});
    }
    ++walk.tested;
  }
  const std::uint32_t limit = std::min(ray.best, walk.best);
  if (limit == hit_that_ends) {
    LaneWalk::end_leaf(its);
  }
  for (;;) {
    if (const std::uint32_t* const words = std::exchange(walk.branch, nullptr)) {
      const accel::EnteredChildren met(words[0]);
      std::array<SharedEntry, accel::EnteredChildren::most> entered;
      std::size_t count = 0;
      for (std::uint32_t k = 0; k < met.count(); ++k) {
        if (const std::uint32_t rank = words[1 + 2 * k] + 1; rank <= limit) {
          entered[count++] = {rank, tree[walk.visited].first + met[k], ray.words + words[2 + 2 * k]};
        }
      }
      walk.waiting.add(entered.data(), count);
    }
    if (shared_.walk.next_of_leaf(its, statistics_.steps)) {
      walk.tests = its.record.kind == memory::RecordKind::primitive;
      return true;
    }
    SharedEntry next;
    do {
      if (walk.waiting.empty()) {
        walk.waiting.clear();
        return false;
      }
      next = walk.waiting.take(walk.visited);
    } while (next.rank > limit);
    walk.visited = next.number;
    if (!lane_treelets_.empty()) {
      follow(warp, number, program::make_word(program::Step::branch, next.number));
    }
    if (!tree[next.number].leaf) {
      walk.branch = next.words;
      if (shared_.walk.visit_branch(its, next.number, statistics_.steps)) {
        return true;
      }
      continue;
    }
    walk.tested = 0;
    walk.hits = next.words + 1;
    walk.hits_end = walk.hits + 2 * std::size_t{next.words[0]};
    const std::uint32_t tests =
        ray.shadow && walk.hits != walk.hits_end ? walk.hits[0] + 1 : tree[next.number].count;
    if (shared_.walk.visit_leaf(its, next.number, tests, statistics_.steps)) {
      return true;
    }
  }
}

// A lane has no work any more.
void SimtNode::leave_shared(std::uint32_t warp, std::uint32_t number) {
  const std::size_t ray = shared_lanes_[place_of(warp, number)].ray;
  lane(warp, number).origin.begin_ray(lane(warp, number).ray);  // in place of the one that it has helped
  if (--shared_rays_[ray].lanes == 0) {
    const std::uint32_t lanes = shared_.input.config.simt.lanes;
    end_ray(warps_[home_of(warp, static_cast<std::uint32_t>(ray % lanes)) / lanes].trace_began);
  }
}

// A lane of the warp that has no work takes an entry of the one that has most.
void SimtNode::help(std::uint32_t number) {
  Warp& warp = warps_[number];
  const Lanes idle =
      (is_group(number) ? warp.members : lowest(shared_.input.config.simt.lanes)) & ~warp.tracing;
  if (idle == 0) {
    return;
  }
  std::size_t most = 1;
  std::uint32_t giver = 0;
  for_each_lane(warp.tracing, [&](std::uint32_t member) {
    if (const std::size_t waiting = shared_lanes_[place_of(number, member)].waiting.size(); waiting > most) {
      most = waiting;
      giver = member;
    }
  });
  if (most == 1) {
    return;
  }
  const auto helper = static_cast<std::uint32_t>(std::countr_zero(idle));
  SharedLane& from = shared_lanes_[place_of(number, giver)];
  SharedLane& to = shared_lanes_[place_of(number, helper)];
  const SharedEntry entry = from.waiting.take_oldest();
  to.ray = from.ray;
  to.best = no_hit;
  to.visited = from.visited;
  to.waiting.add(&entry, 1);
  const auto owner = static_cast<std::uint32_t>(to.ray % shared_.input.config.simt.lanes);
  lane(number, helper).origin.begin_ray(lane(number, owner).ray);
  if (!lane_treelets_.empty()) {
    lane_treelet(number, helper) = no_treelet;
  }
  ++shared_rays_[to.ray].lanes;
  ++time_.counts().helps;
  if (next_shared(number, helper)) {
    warp.tracing |= Lanes{1} << helper;
    warp.wants |= Lanes{1} << helper;
    move(number, Lanes{1} << helper, without_work(number, helper), LaneState::scheduler);
  } else {
    leave_shared(number, helper);
  }
  queue_.push(cycle_ + 1, {});  // the next lane may help then
}

// The end of step 3: then all lanes know what was found.
void SimtNode::help_each_other() {
  for (const std::uint32_t warp : in_unit_) {
    help(warp);
  }
  for (const FoundHit& hit : found_) {
    std::uint32_t& best = shared_rays_[hit.ray].best;
    best = std::min(best, hit.rank);
  }
  found_.clear();
}

}  // namespace marti::processors::simt
