// Rays that are sorted before they enter the unit (docs/internals/rt-unit.md, Sorting rays). A group of
// sorted rays is a warp in the unit: what is known of each of their lanes moves to a place of the group, and
// back when the group leaves.
#include <algorithm>
#include <tuple>
#include <utility>

#include "processors/program/ray_grid.h"
#include "processors/simt/simt_node.h"

namespace marti::processors::simt {

namespace {

struct SortedRay {
  std::uint32_t key = 0;
  std::uint64_t pixel = 0;
  std::uint32_t warp = 0;
  std::uint32_t lane = 0;

  friend bool operator<(const SortedRay& a, const SortedRay& b) {
    return std::tie(a.key, a.pixel) < std::tie(b.key, b.pixel);
  }
};

}  // namespace

// The rays that a warp traces, which must not wait for the unit.
void SimtNode::put_into_pool(std::uint32_t number) {
  Warp& warp = warps_[number];
  place(number, LaneState::held, 0);
  move(number, warp.tracing, LaneState::held, LaneState::unit);
  warp.does = Does::traces;
  warp.pooled = warp.away = static_cast<std::uint32_t>(count(warp.tracing));
  for_each_lane(warp.tracing, [&](std::uint32_t member) { pool_.push_back({number, member}); });
}

// Whether rays can be taken out of the pool: so many that are sorted together, or all because no warp can add
// one.
bool SimtNode::pool_closes() const {
  if (pool_.empty()) {
    return false;
  }
  return pool_.size() >= shared_.input.config.rt.sort_rays ||
         std::all_of(warps_.begin(), warps_.begin() + shared_.input.config.simt.warps,
                     [](const Warp& warp) { return warp.over || warp.pooled > 0; });
}

void SimtNode::sort_pool() {
  while (pool_closes()) {
    form_groups(std::min<std::size_t>(pool_.size(), shared_.input.config.rt.sort_rays));
  }
}

// Of the rays that have come first.
void SimtNode::form_groups(std::size_t rays) {
  const machine::MachineConfig& config = shared_.input.config;
  std::vector<SortedRay> sorted;
  for (; rays > 0; --rays) {
    const auto [number, member] = pool_.front();
    pool_.pop_front();
    Warp& warp = warps_[number];
    --warp.pooled;
    const walk::PixelPlace pixel = pixel_of(warp.packet, warp.turn * config.simt.lanes + member);
    const Lane& its = lane(number, member);
    std::uint32_t key = its.ray;  // the bounce is above the kind
    if (config.rt.sort != machine::RaySort::kind) {
      const std::uint32_t word = shared_.input.log.ray_words(pixel.x, pixel.y)[its.rays - 1];
      key = config.rt.sort == machine::RaySort::origin ? word >> program::direction_bits
                                                       : word & ((1U << program::direction_bits) - 1U);
    }
    sorted.push_back({key, std::uint64_t{pixel.y} * shared_.input.log.width + pixel.x, number, member});
  }
  std::sort(sorted.begin(), sorted.end());
  const std::size_t lanes = config.simt.lanes;
  for (std::size_t first = 0; first < sorted.size(); first += lanes) {
    const std::uint32_t number = take_group();
    const auto members = static_cast<std::uint32_t>(std::min(lanes, sorted.size() - first));
    Warp& group = warps_[number];
    group.members = group.tracing = lowest(members);
    group.trace_began = sim::add_ticks(cycle_, config.rt.sort_cycles);
    queue_.push(sim::add_ticks(group.trace_began, 1), {});
    unit_waiters_.push_back(number);
    for (std::uint32_t member = 0; member < members; ++member) {
      const SortedRay& ray = sorted[first + member];
      homes_[place_of(number, member)] = place_of(ray.warp, ray.lane);
      move_lane(place_of(ray.warp, ray.lane), place_of(number, member));
    }
    ++time_.counts().sorted_warps;
    time_.counts().sorted_rays += members;
  }
}

// The number of a group, with room for its lanes.
std::uint32_t SimtNode::take_group() {
  if (!free_groups_.empty()) {
    const std::uint32_t number = free_groups_.back();
    free_groups_.pop_back();
    return number;
  }
  warps_.emplace_back();
  const auto lanes = warps_.size() * shared_.input.config.simt.lanes;
  lanes_.resize(lanes);
  homes_.resize(lanes);
  stacks_.resize(stacks_.empty() ? 0 : lanes);
  spilled_stacks_.resize(spilled_stacks_.empty() ? 0 : lanes);
  lane_treelets_.resize(lane_treelets_.empty() ? 0 : lanes);
  if (shares()) {
    make_room_to_share();
  }
  return static_cast<std::uint32_t>(warps_.size() - 1);
}

// The group leaves the unit: its rays go back to their lanes.
void SimtNode::end_group(std::uint32_t number) {
  const std::uint32_t lanes = shared_.input.config.simt.lanes;
  for_each_lane(warps_[number].members, [&](std::uint32_t member) {
    const std::size_t home = home_of(number, member);
    move_lane(place_of(number, member), home);
    const auto warp = static_cast<std::uint32_t>(home / lanes);
    if (--warps_[warp].away == 0) {
      begin_shading(warp, warps_[warp].picked);
    }
  });
  free_groups_.push_back(number);
}

// Takes what is known of a lane to another place.
void SimtNode::move_lane(std::size_t from, std::size_t to) {
  std::swap(lanes_[from], lanes_[to]);
  if (!stacks_.empty()) {
    std::swap(stacks_[from], stacks_[to]);
  }
  if (!spilled_stacks_.empty()) {
    std::swap(spilled_stacks_[from], spilled_stacks_[to]);
  }
  if (!lane_treelets_.empty()) {
    lane_treelets_[to] = lane_treelets_[from];
  }
  if (shares()) {
    std::swap(shared_lanes_[from], shared_lanes_[to]);
    std::swap(shared_rays_[from], shared_rays_[to]);
    shared_lanes_[to].ray = to;
  }
}

}  // namespace marti::processors::simt
