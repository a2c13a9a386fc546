// One SIMT node: what happens in each of its cycles (docs/internals/rt-unit.md, The order of one cycle). It
// knows no events: its user calls it in cycles in which something is due, and takes what it asks for.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "accel/record_order.h"
#include "memory/interconnect.h"
#include "processors/simt/cycle_queue.h"
#include "processors/simt/lane_stack.h"
#include "processors/simt/lane_walk.h"
#include "processors/simt/line_registers.h"
#include "processors/simt/node_time.h"
#include "processors/simt/pool.h"
#include "processors/simt/prefetch_queue.h"
#include "processors/simt/rt_unit.h"
#include "processors/simt/sector_caches.h"
#include "processors/simt/shared_rays.h"
#include "processors/simt/short_stack.h"
#include "processors/simt/warp.h"
#include "processors/walk/behind_cache.h"
#include "processors/walk/cache_counting.h"
#include "processors/walk/record_places.h"

namespace marti::processors::simt {

/// Steps of a round without a unit: branches, instances, leaves, cuts, passes; then tests of triangles,
/// spheres, cones.
inline constexpr std::size_t round_visits = 5;
inline constexpr std::size_t round_steps = 8;
using RoundCounts = std::array<std::int64_t, round_steps>;

/// What all nodes share. Prices are in cycles.
struct SimtShared {
  explicit SimtShared(const walk::ReplayInput& replay);

  const walk::ReplayInput& input;
  LaneWalk walk;
  SectorCaches caches;
  walk::BehindCache behind;
  std::optional<accel::Treelets> treelets{};      ///< where the scheduler or prefetching rests on them
  std::vector<std::uint32_t> order_treelets{};    ///< of each node, where lanes that help take nodes by them
  std::optional<walk::CacheCounting> counting{};  ///< where it is asked for
  walk::Observer* listener = nullptr;             ///< that hears references
  std::array<std::int64_t, shader_steps> shader_cycles{};
  std::array<std::int64_t, tests> test_cycles{};  ///< of the unit
  RoundCounts round_cycles{};
  unsigned unit_shift = 0;           ///< from addresses to lines
  walk::StackPlaces stack_places{};  ///< where stacks are in memory
  ShortStack::Size stack_size{};

  /// Calls use(unit) for each line, or sector, that holds some of the bytes, in the order of addresses.
  template <class Use>
  void each_unit(memory::Address at, std::uint64_t bytes, const Use& use) const {
    const memory::Address last = (at + bytes - 1) >> unit_shift;
    for (memory::Address unit = at >> unit_shift; unit <= last; ++unit) {
      use(static_cast<std::uint32_t>(unit));
    }
  }

  /// The first cycle that begins at or after `time`.
  [[nodiscard]] std::int64_t cycle_at(sim::Ticks time) const {
    const sim::Ticks period = input.config.clock.period();
    return time / period + (time % period != 0 ? 1 : 0);
  }
};

/// Tells a node what its write buffer can take.
class WriteRoom {
 public:
  virtual ~WriteRoom() = default;
  /// Whether node `node` may post another write now, after `queued` that it posts in this cycle.
  [[nodiscard]] virtual bool has_room(std::uint32_t node, std::size_t queued) const = 0;
};

class SimtNode {
 public:
  SimtNode(SimtShared& shared, const WriteRoom& room, cost::NodeStatistics& statistics, std::uint32_t number);

  /// What the node asks for in a cycle; its user takes it and clears it.
  std::vector<memory::Transaction> reads;  ///< ports are registers
  std::vector<Write> writes;
  std::vector<std::uint32_t> asks;  ///< warps that ask for a packet

  /// Steps 1 to 6 of a cycle.
  void step(std::int64_t cycle);
  /// Step 8.
  void look_up(std::int64_t cycle);
  /// The first cycle in which something is due; no_cycle if only others can move the node on.
  [[nodiscard]] std::int64_t next_cycle() const { return queue_.next(); }

  /// A warp's packet reaches it in the present cycle, after step 6.
  void begin_packet(std::uint32_t warp, const machine::Packet& packet);
  /// It reaches it in a later cycle.
  void expect_packet(std::uint32_t warp, const machine::Packet& packet, std::int64_t cycle);
  /// No packet is left for the warp. True when none is left for the node.
  bool end_warp(std::uint32_t warp);
  [[nodiscard]] bool finished() const { return live_ == 0; }
  /// The line of a register arrives, which became known in cycle `known`, or before the next.
  void arrives(std::uint32_t number, const memory::Service& service, std::int64_t known);
  /// The write that was held may find room from a cycle on.
  void wake(std::int64_t cycle) {
    cycle = std::max(cycle, stepped_ + 1);
    if (std::exchange(woken_, cycle) != cycle) {
      queue_.push(cycle, {});
    }
  }
  [[nodiscard]] bool waits_for_room() const { return !writers_.empty(); }

  /// Accounts for the time up to a cycle, exclusive.
  void settle(std::int64_t cycle);
  [[nodiscard]] const NodeTime& time() const { return time_; }
  [[nodiscard]] NodeTime& time() { return time_; }
  /// The sums of the parts of all reads beyond the node.
  [[nodiscard]] const std::array<sim::Sum, 4>& read_parts() const { return read_parts_; }
  /// When the last line that it asked for beyond the node arrives.
  [[nodiscard]] sim::Ticks last_arrival() const { return last_arrival_; }
  /// What became of its prefetches.
  [[nodiscard]] walk::ContextCounts prefetches() const { return prefetches_.counts(); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  // Waiters of lines: accesses, and warps for their phases.
  static constexpr std::uint32_t phase_bit = 1U << 31U;

  // Where lists of all lanes have a warp's lane.
  [[nodiscard]] std::size_t place_of(std::uint32_t warp, std::uint32_t number) const {
    return std::size_t{warp} * shared_.input.config.simt.lanes + number;
  }
  Lane& lane(std::uint32_t warp, std::uint32_t number) { return lanes_[place_of(warp, number)]; }
  LaneStack& stack(std::uint32_t warp, std::uint32_t number) { return stacks_[place_of(warp, number)]; }
  std::uint32_t& lane_treelet(std::uint32_t warp, std::uint32_t number) {
    return lane_treelets_[place_of(warp, number)];
  }

  void set_packet(std::uint32_t warp, const machine::Packet& packet, std::int64_t cycle);

  // simt_phases.cpp: warps beside the unit.
  void advance(std::uint32_t warp);
  void begin_turn(std::uint32_t warp);
  void begin_shading(std::uint32_t warp, Lanes members);
  void begin_trace(std::uint32_t warp);
  bool next_round_records(std::uint32_t warp, Lanes lanes);
  void begin_phase(std::uint32_t warp, Does does);
  void ask_for_slot(std::uint32_t warp);
  [[nodiscard]] static bool phase_done(const Warp& warp);
  void refresh_phase(std::uint32_t warp);
  void end_shading(std::uint32_t warp);
  void go_on(std::uint32_t warp);
  void write_out();
  void give_slots();
  void place(std::uint32_t warp, LaneState state, Lanes lanes);
  void count_ray(std::uint32_t warp, std::uint32_t number);
  void end_ray(std::int64_t began);

  // rt_unit.cpp: warps in the unit.
  void leave_and_enter();
  bool pick_access();
  /// A lane that wants a record, and its warp.
  struct Picked {
    std::uint32_t warp = 0;
    std::uint32_t lane = 0;
  };
  [[nodiscard]] std::optional<Picked> pick_lane();
  [[nodiscard]] std::optional<std::uint32_t> pick_warp() const;
  [[nodiscard]] std::optional<Picked> pick_by_treelet();
  void place_access(Access& access, LaneState state);
  void complete(std::uint32_t number);
  void begin_test(const WarpLanes& lanes, Test test, LaneState from);
  void begin_waiting_tests();
  void end_test(const WarpLanes& lanes, LaneState from);
  bool begin_ray(std::uint32_t warp, std::uint32_t number);
  bool next_record(std::uint32_t warp, std::uint32_t number);
  void follow(std::uint32_t warp, std::uint32_t number, std::uint32_t visit);
  void put_prefetches();
  [[nodiscard]] bool leaves(std::uint32_t warp) const {
    return warps_[warp].tracing == 0 && warps_[warp].unposted == 0;
  }

  // ray_pool.cpp: rays that are sorted before they enter the unit.
  [[nodiscard]] bool is_group(std::uint32_t warp) const { return warp >= shared_.input.config.simt.warps; }
  // Where lists of all lanes have the lane of a warp whose ray is at this place, in a group or not.
  [[nodiscard]] std::size_t home_of(std::uint32_t warp, std::uint32_t number) const {
    const std::size_t place = place_of(warp, number);
    return is_group(warp) ? homes_[place] : place;
  }
  void put_into_pool(std::uint32_t warp);
  [[nodiscard]] bool pool_closes() const;
  void sort_pool();
  void form_groups(std::size_t rays);
  std::uint32_t take_group();
  void end_group(std::uint32_t group);
  void move_lane(std::size_t a, std::size_t b);

  // spilled_stacks.cpp: stacks that are in memory in part.
  struct SpilledStack;
  SpilledStack& spilled_stack(std::uint32_t warp, std::uint32_t number) {
    return spilled_stacks_[place_of(warp, number)];
  }
  // The address of a line of a lane's stack.
  [[nodiscard]] memory::Address stack_line(std::uint32_t warp, std::uint32_t number,
                                           std::uint32_t line) const {
    return shared_.stack_places.of(number_ % shared_.input.config.nodes, home_of(warp, number)) +
           std::uint64_t{line} * shared_.input.config.reference_bytes();
  }
  bool read_stack(std::uint32_t warp, std::uint32_t number);
  bool move_stack(std::uint32_t warp, std::uint32_t number, const std::uint32_t* visit);
  void write_stacks();

  // shared_rays.cpp: lanes that help each other.
  [[nodiscard]] bool shares() const { return shares_; }
  // What a lane of the unit is that has no work.
  [[nodiscard]] LaneState without_work(std::uint32_t warp, std::uint32_t number) const {
    const bool pixel = is_group(warp) || (warps_[warp].pixels >> number & 1U) != 0;
    return pixel ? LaneState::held : LaneState::empty;
  }
  void make_room_to_share();
  bool begin_shared(std::uint32_t warp, std::uint32_t number);
  bool next_shared(std::uint32_t warp, std::uint32_t number);
  void leave_shared(std::uint32_t warp, std::uint32_t number);
  void help(std::uint32_t warp);
  void help_each_other();

  // Counts lanes of a warp, or of a group, as being in another state.
  void move(std::uint32_t warp, Lanes lanes, LaneState from, LaneState to) {
    time_.move_lanes(from, to, count(lanes));
    if (told_) [[unlikely]] {
      tell_of_lanes(warp, lanes, from);
    }
  }
  void tell_of_lanes(std::uint32_t warp, Lanes lanes, LaneState from);
  // Where lists of all lanes have the one whose ray, or pixel, a lane works for.
  [[nodiscard]] std::size_t works_for(std::uint32_t warp, std::uint32_t number) const {
    if (shares() && (is_group(warp) || warps_[warp].does == Does::traces)) {
      number = static_cast<std::uint32_t>(shared_lanes_[place_of(warp, number)].ray %
                                          shared_.input.config.simt.lanes);
    }
    return home_of(warp, number);
  }
  [[nodiscard]] walk::PixelPlace pixel_at(std::size_t place) const {
    const std::uint32_t lanes = shared_.input.config.simt.lanes;
    const Warp& warp = warps_[place / lanes];
    return pixel_of(warp.packet, warp.turn * lanes + static_cast<std::uint32_t>(place % lanes));
  }

  // Lines.
  [[gnu::noinline]] void tell_of_look_up(const LineRead& line, bool hit);
  bool look_up_line(std::uint32_t waiter, const LineRead& line);
  void look_up_prefetch();
  std::uint32_t ask_for_line(LineRegisters::Key key, const LineRead& line, bool prefetched);
  void line_there(std::uint32_t waiter, bool left);
  void count_pending(std::uint32_t waiter, bool left);

  SimtShared& shared_;
  const WriteRoom& room_;
  cost::NodeStatistics& statistics_;
  std::uint32_t number_;
  std::int64_t cycle_ = 0;
  std::int64_t stepped_ = -1;  // the last cycle whose step() was called
  std::int64_t woken_ = -1;    // the cycle of the last wake()

  std::vector<Warp> warps_;  // and, behind them, groups of sorted rays, which are warps in the unit
  std::vector<Lane> lanes_;
  CycleQueue queue_;
  LineRegisters registers_;
  NodeTime time_;
  std::array<sim::Sum, 4> read_parts_{};  // interconnect wait, transfer, bank wait, bank
  std::uint64_t touched_ = 0;             // warps that may go on in step 5
  std::uint32_t live_;                    // warps that may still get a packet
  std::uint32_t without_packet_;          // of these, those that have none
  std::int64_t hits_pending_ = 0;         // lines that are there later, from the first level
  std::int64_t tests_running_ = 0;
  std::int64_t full_from_ = no_cycle;  // since when a look-up finds no register
  sim::Ticks last_arrival_ = 0;

  std::vector<Slot> slots_;                  // in the order in which they were taken
  std::vector<std::uint32_t> slot_waiters_;  // warps, in the order in which they are served
  std::vector<std::uint32_t> readers_;       // warps whose phases have lines to look up, in that order
  // What waits for the write buffer: the pixels of a warp, or a line of the stack of one of its lanes.
  struct Writer {
    std::uint32_t warp = 0;
    std::optional<memory::Address> line{};
  };
  std::deque<Writer> writers_;

  // The unit.
  Pool<Access> accesses_;
  Pool<RunningTest> running_;
  std::vector<std::uint32_t> in_unit_;         // warps, in the order in which they entered
  std::deque<std::uint32_t> unit_waiters_;     // warps, in the order in which they are served
  std::uint64_t entered_ = 0;                  // warps that have entered
  std::uint64_t unit_slots_ = 0;               // taken ones
  std::uint32_t last_slot_ = 0;                // whose warp was picked last; round_robin: where to look first
  std::optional<std::uint64_t> last_entered_;  // Warp::entered of the warp picked last
  std::uint32_t sending_ = no_access;          // the access whose lines are looked up
  std::vector<WaitingTest> waiting_boxes_;
  std::vector<WaitingTest> waiting_primitives_;
  std::size_t new_boxes_ = 0;  // of the above, at the end, those that came in this cycle
  std::size_t new_primitives_ = 0;
  static constexpr std::uint32_t no_access = ~std::uint32_t{0};

  struct Ending {
    WarpLanes lanes;
    LaneState from = LaneState::box;
  };
  std::vector<Ending> ending_;  // tests that end in this cycle

  // Prefetching into the unit.
  struct Wish {
    std::uint64_t entered = 0;  // of the lane's warp
    std::uint32_t lane = 0;
    std::uint32_t first = 0;  // of wished_
    std::uint32_t end = 0;
    std::uint32_t treelet = no_treelet;
  };
  static constexpr std::uint32_t no_treelet = ~std::uint32_t{0};
  PrefetchQueue prefetches_;
  std::vector<LaneStack> stacks_;      // of each lane of each warp; empty where none is asked for
  std::vector<Wish> wishes_;           // of this cycle
  std::vector<std::uint32_t> wished_;  // nodes of the tree

  // Sorting rays.
  struct PooledRay {
    std::uint32_t warp = 0;
    std::uint32_t lane = 0;
  };
  std::deque<PooledRay> pool_;              // in the order in which they came
  std::vector<std::size_t> homes_;          // of each lane of each group, where its ray is from
  std::vector<std::uint32_t> free_groups_;  // numbers that warps_ has room for

  // Stacks in memory.
  struct SpilledStack {
    ShortStack stack;
    std::uint32_t to_read = 0;  // lines that the lane has still to read back
    bool goes_on = false;       // with a visit, when it has read them
    std::uint32_t visit = 0;    // its word
    Record record;              // its first one
  };
  struct Spill {
    std::uint64_t entered = 0;  // of the lane's warp
    std::uint32_t lane = 0;
    std::uint32_t warp = 0;
    memory::Address line = 0;
  };
  std::vector<SpilledStack> spilled_stacks_;  // of each lane of each warp; empty with all on chip
  std::vector<Spill> spills_;                 // of this cycle

  // Lanes that help each other; empty where they do not.
  bool shares_;
  std::vector<SharedLane> shared_lanes_;  // of each lane of each warp
  std::vector<SharedRay> shared_rays_;    // of each lane of each warp, its ray
  struct FoundHit {
    std::size_t ray = 0;  // of shared_rays_
    std::uint32_t rank = 0;
  };
  std::vector<FoundHit> found_;  // in this cycle

  // Since when each lane of each warp is in its state; empty where nobody hears of lanes.
  std::vector<std::int64_t> lane_since_;
  bool told_ = false;  // somebody hears of lanes or references

  // Treelets.
  std::vector<std::uint32_t> lane_treelets_;  // of the record that each lane of each warp wants or has
  std::uint32_t last_treelet_ = no_treelet;   // that the scheduler picked
  std::vector<std::uint32_t> wanted_;         // one for each lane that wants a record: its treelet
  std::vector<std::uint32_t> completed_;
};

}  // namespace marti::processors::simt
