#include "tests/support/naive_simt.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "processors/node/memory_system.h"
#include "processors/node/node_array.h"
#include "processors/walk/local_memory.h"
#include "processors/walk/node_caches.h"
#include "sim/engine.h"
#include "tests/support/naive_prefetch.h"
#include "tests/support/naive_share.h"
#include "tests/support/naive_simt_log.h"
#include "tests/support/naive_tags.h"

namespace marti::test {

namespace {

using processors::node::EventClass;
using processors::replay::MachineResult;
using Cycle = std::int64_t;

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

// A line on its way to the lanes that looked it up.
struct Line {
  Cycle there = never;
  bool left = false;   // the node, to bring it
  bool wanted = true;  // a look-up waits for it, not only a prefetch
  bool came = false;   // step 2 of a cycle has seen it
};
using Lines = std::vector<std::shared_ptr<Line>>;

struct LookUp {
  memory::RecordKind kind;
  std::uint64_t line;
};

// Lines that are looked up one after the other: of an access of the unit, or of a phase or round.
struct Reading {
  std::deque<LookUp> left;
  Lines lines;
  [[nodiscard]] bool done() const {
    return left.empty() &&
           std::all_of(lines.begin(), lines.end(), [](const auto& line) { return line->came; });
  }
  [[nodiscard]] bool waits_for_memory() const {
    return std::any_of(lines.begin(), lines.end(),
                       [](const auto& line) { return line->left && !line->came; });
  }
};

struct Lane {
  bool pixel = false;  // in this turn
  std::size_t number = 0;
  std::span<const std::uint32_t> words;
  std::span<const std::uint32_t> entered;  // of the branches whose visits come next
  std::size_t next = 0;
  std::optional<std::uint32_t> ray;  // the operand of the `ray` step whose visits come next
  std::size_t next_ray = 0;          // how many `ray` steps it has taken
  std::size_t rays = 0;              // that it took before this one
  std::optional<NaiveOnWay> way;     // of its ray, from when that is asked about hits
  bool goes_back = false;            // its ray has been asked
  bool picked = false;
  bool away = false;      // its ray is in the pool, or in a group
  std::size_t place = 0;  // of its group
  Cycle trace_began = 0;
  std::size_t warp = 0;
  std::vector<NaiveVisit> visits;
  std::vector<memory::Address> last_spills;
  std::size_t at = 0;
  std::span<const std::uint32_t> meets;  // what the rays meet that come next
  NaiveSharedLane shared;                // where lanes help each other
  // In the unit.
  enum class In { none, wants, reads, waits, tests, done } in = In::none;
  std::shared_ptr<Reading> access;
  Cycle came = 0;  // its record
  Cycle ends = 0;  // its test
  [[nodiscard]] const NaiveRecord& record() const { return *visits[at].record; }
  [[nodiscard]] bool works() const {
    return in == In::wants || in == In::reads || in == In::waits || in == In::tests;
  }
};

struct Phase {
  Cycle began = 0;
  bool round = false;
  std::vector<std::size_t> lanes;
  Reading reading;
  NaiveCycles cycles;
  std::optional<Cycle> slot;  // when it got one
  bool computed = false;
  // A round computes with what it has read.
  [[nodiscard]] bool wants_slot() const { return !slot && !computed && (!round || reading.done()); }
  [[nodiscard]] bool computes() const { return slot && !computed; }
};

struct Warp {
  enum class Does { ask, wait_for_packet, phase, traces, left_unit, write, written, nothing };
  Does does = Does::ask;
  bool asked = false;
  sim::Ticks start = 0;
  Cycle reached = 0;  // by the packet
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pixels;
  std::size_t turn = 0;
  std::vector<Lane> lanes;
  Phase phase;
  Cycle trace_began = 0;
  std::deque<memory::Transaction> writes;
  [[nodiscard]] bool has_packet() const {
    return does != Does::ask && does != Does::wait_for_packet && does != Does::nothing;
  }
};

// Rays that are in the unit together: those of a warp or, where rays are sorted, of several. By their places.
struct Group {
  std::vector<Lane*> lanes;
  Cycle waits = 0;            // for the unit, since that cycle
  std::uint64_t entered = 0;  // the unit: a number that grows
  std::size_t unposted = 0;   // lines of its lanes' stacks
};

struct Register {
  std::shared_ptr<Line> line;  // null: free
  NaiveLine number;
  Cycle asked = 0;
};

struct WriteEntry {
  Cycle posted = -1;
  sim::Ticks end = 0;
};

struct Node {
  Cycle cycle = 0;
  std::vector<Warp> warps;
  std::vector<NaiveTags> caches;
  std::vector<NaiveTags> second;  // one, or none
  memory::CacheCounters second_counts;
  NaivePrefetch prefetch{0};
  std::vector<Register> registers;
  Lines coming;                              // by no register
  std::deque<Lane*> pool;                    // rays that wait to be sorted
  std::deque<std::shared_ptr<Group>> ready;  // they wait for the unit, without sorting in the order of warps
  std::vector<std::shared_ptr<Group>> unit;  // what each slot has; null: nothing
  std::uint64_t entries = 0;
  std::shared_ptr<Group> picked_group;
  std::optional<std::uint32_t> picked_treelet;
  std::size_t next_slot = 0;
  std::vector<std::shared_ptr<Reading>> accesses;  // not complete
  std::shared_ptr<Reading> sending;
  std::optional<std::size_t> stuck;             // the warp whose phase found no register
  std::optional<memory::RecordKind> looked_up;  // in this cycle
  struct Writer {
    std::size_t warp = 0;  // whose pixels are written; or a line of a stack of the group
    std::shared_ptr<Group> group{};
    memory::Address line = 0;
  };
  std::deque<Writer> writers;
  std::vector<WriteEntry> buffer;           // the entry to take next comes first
  std::deque<std::size_t> posted;           // entries whose end is not known
  std::deque<memory::Transaction> to_post;  // in this cycle
  std::size_t next_entry = 0;
  Cycle memory_cycles = 0;
  memory::Service parts;
  NodeStatistics statistics;
  processors::walk::SimtCounts counts;
  bool finished = false;
};

class NaiveSimt final : public sim::EventHandler {
 public:
  NaiveSimt(const WorkLog& log, const MachineConfig& machine)
      : log_(log),
        machine_(machine),
        layout_(layout_of(log, machine)),
        program_(log, machine, layout_),
        ticks_(step_ticks(machine, log)),
        period_(machine.clock.period()),
        unit_(machine.simt.sector != 0 ? machine.simt.sector : machine.cache.cache.line),
        packets_(log.width, log.height, machine.packets),
        host_(machine.host, packets_.size(), machine.all_nodes()),
        nodes_(machine.all_nodes()) {
    for (std::uint32_t number = 0; number < nodes_.size(); ++number) {
      Node& node = nodes_[number];
      node.warps.resize(machine.simt.warps);
      for (const FirstLevelCache& first : first_level_caches(machine.cache)) {
        node.caches.emplace_back(first.cache, number);
      }
      if (machine.l2.sharing == SecondLevel::private_caches) {
        node.second.emplace_back(second_level_cache(machine), number);
      }
      node.prefetch = NaivePrefetch(machine.prefetch.queue);
      node.registers.resize(machine.simt.mshrs);
      node.unit.resize(machine.rt.warps);
      node.buffer.resize(machine.write_buffer);
    }
    for (const EventClass c : {EventClass::step, EventClass::dispatch, EventClass::reply, EventClass::read,
                               EventClass::write, EventClass::memory}) {
      engine_.attach(static_cast<std::uint8_t>(c), *this);
    }
    clients_.resize(machine.clusters);
    const std::uint32_t ports = machine.nodes * machine.simt.mshrs;
    for (std::uint32_t cluster = 0; cluster < machine.clusters; ++cluster) {
      clients_[cluster].all = this;
      clients_[cluster].first = cluster * machine.nodes;
      interconnects_.push_back(processors::node::make_memory_system(
          machine, {engine_, clients_[cluster], static_cast<std::uint8_t>(EventClass::reply), cluster * ports,
                    ports, static_cast<std::uint8_t>(EventClass::memory), true}));
    }
  }

  MachineResult run() {
    for (std::uint32_t number = 0; number < nodes_.size(); ++number) {
      post(EventClass::step, 0, number);
    }
    engine_.run(std::numeric_limits<std::uint64_t>::max());
    MachineResult result;
    result.end = end_;
    result.host = host_.statistics();
    for (Node& node : nodes_) {
      spend(node, Activity::idle, end_ - node.statistics.finish);
      divide_memory(node);
      result.nodes.push_back(node.statistics);
      result.simt.nodes.push_back(node.counts);
      if (machine_.prefetch.stack > 0 || machine_.prefetch.treelet) {
        result.contexts.nodes.push_back(node.prefetch.counts());
      }
      if (!node.second.empty()) {
        result.l2.caches.push_back(node.second_counts);
      }
    }
    for (const auto& interconnect : interconnects_) {
      result.clusters.push_back({interconnect->statistics(), interconnect->bank_statistics()});
      result.clusters.back().dram = interconnect->dram_statistics(result.end);
      if (const memory::SharedCacheStatistics* const cache = interconnect->cache_statistics()) {
        result.l2.caches.push_back(cache->lookups);
        result.l2.waits.push_back(cache->waits);
      }
    }
    result.packets = packets_.size();
    result.pixels = std::uint64_t{log_.width} * log_.height;
    result.database_bytes = layout_.database_bytes();
    result.copies = replicated() ? machine_.all_nodes() : machine_.clusters;
    result.leaf_records = !accel::walks_bvh(log_.traversal);
    result.unloaded_miss = interconnects_.front()->unloaded_read(unit_);
    return result;
  }

  void handle(const sim::Event& event) override {
    const std::uint32_t component = event.component();
    const std::uint32_t ports = machine_.nodes * machine_.simt.mshrs;
    switch (static_cast<EventClass>(event.event_class())) {
      case EventClass::step:
        begin_cycle(component);
        break;
      case EventClass::dispatch:
        ask(component % machine_.all_nodes(), component / machine_.all_nodes());
        break;
      case EventClass::reply:
        interconnects_[component / ports]->reply(component % ports);
        break;
      case EventClass::read:
        look_up_lines(component);
        break;
      case EventClass::write:
        end_cycle(component);
        break;
      case EventClass::memory:
        interconnects_[component / ports]->proceed(component % ports, event.sequence());
        break;
    }
  }

 private:
  struct Client final : memory::InterconnectClient {
    NaiveSimt* all = nullptr;
    std::uint32_t first = 0;
    void read_done(std::uint32_t port, const memory::Service& service) override {
      Node& node = all->nodes_[first + port / all->machine_.simt.mshrs];
      all->arrives(node, node.registers[port % all->machine_.simt.mshrs], service);
    }
    void write_done(std::uint32_t port, sim::Ticks done) override {
      Node& node = all->nodes_[first + port / all->machine_.simt.mshrs];
      all->end_ = std::max(all->end_, done);
      node.buffer[node.posted.front()].end = done;
      node.posted.pop_front();
    }
  };

  static memory::Layout layout_of(const WorkLog& log, const MachineConfig& machine) {
    std::optional<processors::walk::TreePlan> none;
    return processors::walk::layout_of(log, machine, none);
  }
  void post(EventClass c, sim::Ticks time, std::uint32_t component) {
    engine_.post(sim::Event::make(time, static_cast<std::uint8_t>(c), component));
  }
  static void spend(Node& node, Activity activity, sim::Ticks time) {
    node.statistics.time[static_cast<std::size_t>(activity)] += time;
  }
  [[nodiscard]] bool replicated() const { return machine_.placement == Placement::replicated; }
  [[nodiscard]] bool has_unit() const { return machine_.rt.warps > 0; }
  [[nodiscard]] Cycle cycle_at_or_after(sim::Ticks time) const { return (time + period_ - 1) / period_; }

  // ---- steps 1 to 7

  void begin_cycle(std::uint32_t number) {
    Node& node = nodes_[number];
    const Cycle now = node.cycle;
    node.looked_up.reset();
    for (Warp& warp : node.warps) {
      if (warp.does == Warp::Does::wait_for_packet && warp.start <= now * period_) {
        begin_packet(node, warp);
      }
      if (warp.phase.computes() && *warp.phase.slot + warp.phase.cycles.all() <= now) {
        warp.phase.computed = true;
      }
    }
    lines_arrive(node);
    begin_tests(node);
    end_tests(node);
    leave_and_enter(node);
    while (!node.writers.empty() && writes_first(node)) {
      node.writers.pop_front();
    }
    for (std::size_t warp = 0; warp < node.warps.size(); ++warp) {
      advance(node, warp);
    }
    give_slots(node);
    post_requests(number);
    post(EventClass::write, engine_.now(), number);
    post(EventClass::read, engine_.now(), number);
  }

  void lines_arrive(Node& node) {
    const auto see = [&](Line& line) { line.came = line.there <= node.cycle; };
    for (const auto& line : node.coming) {
      see(*line);
    }
    std::erase_if(node.coming, [](const auto& line) { return line->came; });
    for (Register& one : node.registers) {
      if (one.line) {
        see(*one.line);
        if (one.line->came) {
          one.line = nullptr;
        }
      }
    }
    for_lanes_in_unit(node, [&](const auto&, Lane& lane) {
      if (lane.in == Lane::In::reads && lane.access->done()) {
        lane.access = nullptr;
        lane.came = node.cycle;
        lane.in = Lane::In::waits;
      }
    });
  }

  static bool of_box(const Lane& lane) {
    const NaiveTest test = lane.record().test;
    return test == NaiveTest::box || test == NaiveTest::transform || test == NaiveTest::leaf;
  }
  [[nodiscard]] Cycle test_cycles(NaiveTest test) const {
    switch (test) {
      case NaiveTest::box:
        return machine_.rt.box_cycles;
      case NaiveTest::transform:
        return machine_.rt.transform_cycles;
      case NaiveTest::leaf:
        return machine_.rt.leaf_cycles;
      case NaiveTest::triangle:
        return machine_.rt.triangle_cycles;
      case NaiveTest::quadric:
        return machine_.rt.quadric_cycles;
      case NaiveTest::none:
        break;
    }
    return 0;
  }

  void begin_tests(Node& node) {
    std::vector<std::tuple<Cycle, std::uint64_t, std::size_t, Lane*>> waiting;
    for_lanes_in_unit(node, [&](const auto& group, Lane& lane) {
      if (lane.in == Lane::In::waits) {
        waiting.emplace_back(lane.came, group->entered, lane.place, &lane);
      }
    });
    std::sort(waiting.begin(), waiting.end());
    std::uint32_t boxes = 0;
    std::uint32_t primitives = 0;
    for (const auto& [came, entered, number, lane] : waiting) {
      const Cycle cycles = test_cycles(lane->record().test);
      if (cycles > 0) {
        std::uint32_t& used = of_box(*lane) ? boxes : primitives;
        const std::uint32_t units = of_box(*lane) ? machine_.rt.box_units : machine_.rt.triangle_units;
        if (units != 0 && used == units) {
          continue;
        }
        ++used;
      }
      lane->in = Lane::In::tests;
      lane->ends = node.cycle + cycles;
    }
  }

  void end_tests(Node& node) {
    std::map<std::pair<std::uint64_t, std::size_t>, const NaiveVisit*> wishing;
    std::map<std::pair<std::uint64_t, std::size_t>, std::pair<std::shared_ptr<Group>, const Lane*>> ended;
    for_lanes_in_unit(node, [&](const std::shared_ptr<Group>& group, Lane& lane) {
      if (lane.in == Lane::In::tests && lane.ends <= node.cycle) {
        ++lane.at;
        lane.in = Lane::In::wants;
        ended[{group->entered, lane.place}] = {group, &lane};
        if (shares() ? !next_shared(node, lane) : lane.at == lane.visits.size()) {
          lane.in = Lane::In::done;
          if (!shares()) {
            count_ray(node, lane.trace_began, lane.goes_back);
          }
        } else {
          wishing[{group->entered, lane.place}] = &lane.visits[lane.at];
        }
      }
    });
    if (shares()) {
      help(node, wishing);
    }
    for (const auto& [of, visit] : wishing) {
      for (const std::vector<NaiveRecord>& item : visit->wishes) {
        std::deque<LookUp> lines;
        for (const NaiveRecord& record : item) {
          read_lines(record, lines);
        }
        std::optional<std::uint64_t> before;  // records that follow each other may share a line
        for (const LookUp& line : lines) {
          if (before != line.line) {
            node.prefetch.wish(line.kind, line_of(node, line));
          }
          before = line.line;
        }
      }
    }
    for (const auto& [order, of] : ended) {
      const auto& [group, lane] = of;
      const bool done = lane->in == Lane::In::done;
      for (const memory::Address line : done ? lane->last_spills : lane->visits[lane->at].spills) {
        node.writers.push_back({0, group, line});
        ++group->unposted;
        ++node.counts.spills;
      }
    }
  }

  [[nodiscard]] bool shares() const { return machine_.rt.share != RtShare::none; }
  // The lane's next record becomes its last visit; false: it has nothing to do any more.
  bool next_shared(Node& node, Lane& lane) const {
    if (std::optional<NaiveVisit> visit = lane.shared.next(log_, program_)) {
      sim::merge(node.statistics.steps, visit->steps);
      lane.visits.push_back(std::move(*visit));
      lane.at = lane.visits.size() - 1;
      return true;
    }
    NaiveSharedRay& ray = *lane.shared.ray;
    if (--ray.lanes == 0) {
      count_ray(node, ray.began, false);
    }
    return false;
  }
  // In each warp the lowest lane without work takes the oldest entry of the one that has most.
  void help(Node& node, std::map<std::pair<std::uint64_t, std::size_t>, const NaiveVisit*>& wishing) const {
    for (const std::shared_ptr<Group>& group : node.unit) {
      Lane* helper = nullptr;
      Lane* giver = nullptr;
      for (Lane* const lane : group ? group->lanes : std::vector<Lane*>()) {
        if (!lane->works()) {
          helper = helper == nullptr ? lane : helper;
        } else if (lane->shared.entries.size() >= 2 &&
                   (giver == nullptr || lane->shared.entries.size() > giver->shared.entries.size())) {
          giver = lane;
        }
      }
      if (helper == nullptr || giver == nullptr) {
        continue;
      }
      ++node.counts.helps;
      helper->shared = NaiveSharedLane(giver->shared.ray, giver->shared.entries.front());
      giver->shared.entries.erase(giver->shared.entries.begin());
      helper->visits.clear();
      if (next_shared(node, *helper)) {
        helper->in = Lane::In::wants;
        wishing[{group->entered, helper->place}] = &helper->visits.back();
      }
    }
    for_lanes_in_unit(node, [](const auto&, Lane& lane) {
      if (lane.shared.ray) {
        lane.shared.ray->best = lane.shared.ray->found;
      }
    });
  }

  static void count_ray(Node& node, Cycle began, bool goes_back) {
    const Cycle cycles = node.cycle - began;
    ++(goes_back ? node.counts.returns : node.counts.rays);
    node.counts.ray_cycles += cycles;
    node.counts.longest_ray = std::max(node.counts.longest_ray, cycles);
  }

  void leave_and_enter(Node& node) {
    std::shared_ptr<Group>* leaves = nullptr;
    for (std::shared_ptr<Group>& slot : node.unit) {
      if (slot && slot->unposted == 0 &&
          std::all_of(slot->lanes.begin(), slot->lanes.end(),
                      [](const Lane* lane) { return lane->in == Lane::In::done; }) &&
          (leaves == nullptr || slot->entered < (*leaves)->entered)) {
        leaves = &slot;
      }
    }
    if (leaves != nullptr) {
      for (Lane* const lane : (*leaves)->lanes) {
        come_back(node.warps[lane->warp], *lane);
      }
      if (node.picked_group == *leaves) {
        node.picked_group = nullptr;
      }
      leaves->reset();
    }
    sort_pool(node);
    const auto free = std::find(node.unit.begin(), node.unit.end(), nullptr);
    if (free != node.unit.end() && !node.ready.empty() && node.ready.front()->waits < node.cycle) {
      *free = node.ready.front();
      node.ready.pop_front();
      (*free)->entered = node.entries++;
      ++node.counts.traces;
      for (Lane* const lane : (*free)->lanes) {
        lane->in = lane->away ? Lane::In::wants : Lane::In::done;
      }
    }
  }
  // A ray goes back to its lane; when all of a warp's have, the warp goes on.
  static void come_back(Warp& warp, Lane& lane) {
    lane.away = false;
    if (std::none_of(warp.lanes.begin(), warp.lanes.end(), [](const Lane& one) { return one.away; })) {
      warp.does = Warp::Does::left_unit;
    }
  }

  [[nodiscard]] bool sorts() const { return machine_.rt.sort != RaySort::none; }
  // Takes rays that fill the pool out of it, and all if no warp can add another one.
  void sort_pool(Node& node) {
    while (node.pool.size() >= machine_.rt.sort_rays) {
      form_groups(node, machine_.rt.sort_rays);
    }
    const bool nobody_adds = std::all_of(node.warps.begin(), node.warps.end(), [&](const Warp& warp) {
      return warp.does == Warp::Does::nothing ||
             std::any_of(node.pool.begin(), node.pool.end(),
                         [&](const Lane* lane) { return &node.warps[lane->warp] == &warp; });
    });
    if (nobody_adds) {
      form_groups(node, node.pool.size());
    }
  }
  // Of the rays that came to the pool first.
  void form_groups(Node& node, std::size_t rays) {
    std::map<std::pair<std::uint32_t, std::uint64_t>, Lane*> sorted;
    for (; rays > 0; --rays) {
      Lane* const lane = node.pool.front();
      node.pool.pop_front();
      const auto [x, y] = pixel_of(node, *lane);
      sorted[{sort_key(*lane, x, y), std::uint64_t{y} * log_.width + x}] = lane;
    }
    std::size_t place = 0;
    for (const auto& [key, lane] : sorted) {
      lane->place = place++ % machine_.simt.lanes;
      if (lane->place == 0) {
        node.ready.push_back(std::make_shared<Group>());
        node.ready.back()->waits = node.cycle + machine_.rt.sort_cycles;
        ++node.counts.sorted_warps;
      }
      node.ready.back()->lanes.push_back(lane);
      ++node.counts.sorted_rays;
    }
  }
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> pixel_of(const Node& node, const Lane& lane) const {
    const Warp& warp = node.warps[lane.warp];
    return warp.pixels[warp.turn * machine_.simt.lanes + lane.number];
  }
  [[nodiscard]] std::uint32_t sort_key(const Lane& lane, std::uint32_t x, std::uint32_t y) const {
    if (machine_.rt.sort == RaySort::kind) {
      return bounce_of(*lane.ray) * 8 + static_cast<std::uint32_t>(ray_number_of(*lane.ray));
    }
    const std::uint32_t word = log_.ray_words(x, y)[lane.rays];
    return machine_.rt.sort == RaySort::direction ? word % 512 : word / 512;
  }

  template <class Visit>
  static void for_lanes_in_unit(Node& node, const Visit& visit) {
    for (const std::shared_ptr<Group>& slot : node.unit) {
      if (slot) {
        for (Lane* const lane : slot->lanes) {
          visit(slot, *lane);
        }
      }
    }
  }

  void give_slots(Node& node) const {
    for (;;) {
      Warp* best = nullptr;
      std::uint32_t used = 0;
      for (Warp& warp : node.warps) {
        if (warp.does == Warp::Does::phase) {
          used += warp.phase.computes() ? 1 : 0;
          if (warp.phase.wants_slot() && (best == nullptr || warp.phase.began < best->phase.began)) {
            best = &warp;
          }
        }
      }
      if (best == nullptr || used == machine_.simt.issue) {
        return;
      }
      best->phase.slot = node.cycle;
    }
  }

  void post_requests(std::uint32_t number) {
    Node& node = nodes_[number];
    for (std::uint32_t warp = 0; warp < node.warps.size(); ++warp) {
      if (node.warps[warp].does == Warp::Does::ask && !std::exchange(node.warps[warp].asked, true)) {
        post(EventClass::dispatch, engine_.now(), warp * machine_.all_nodes() + number);
      }
    }
  }

  void ask(std::uint32_t number, std::uint32_t which) {
    Node& node = nodes_[number];
    Warp& warp = node.warps[which];
    warp.asked = false;
    const auto grant = host_.next(number, engine_.now());
    if (!grant) {
      warp.does = Warp::Does::nothing;
      node.finished = std::all_of(node.warps.begin(), node.warps.end(),
                                  [](const Warp& other) { return other.does == Warp::Does::nothing; });
      if (node.finished) {
        node.statistics.finish = engine_.now();
        node.counts.cycles = node.cycle;
        end_ = std::max(end_, engine_.now());
      }
      return;
    }
    ++node.statistics.packets;
    warp.does = Warp::Does::wait_for_packet;
    warp.start = grant->start;
    warp.pixels.clear();
    const Packet packet = packets_[grant->packet];
    for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
      for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
        warp.pixels.emplace_back(x, y);
      }
    }
    if (warp.start <= engine_.now()) {
      begin_packet(node, warp);
      advance(node, which);
      give_slots(node);
      post_requests(number);
    }
  }

  // ---- what warps do one after the other

  void begin_packet(Node& node, Warp& warp) {
    warp.reached = node.cycle;
    warp.turn = 0;
    begin_turn(node, warp);
  }

  void begin_turn(Node& node, Warp& warp) {
    warp.lanes.assign(machine_.simt.lanes, Lane{});
    std::vector<std::size_t> lanes;
    for (std::size_t number = 0; number < warp.lanes.size(); ++number) {
      const std::size_t pixel = warp.turn * machine_.simt.lanes + number;
      warp.lanes[number].number = number;
      warp.lanes[number].warp = static_cast<std::size_t>(&warp - node.warps.data());
      if (pixel < warp.pixels.size()) {
        warp.lanes[number].pixel = true;
        warp.lanes[number].words = log_.pixel(warp.pixels[pixel].first, warp.pixels[pixel].second);
        if (log_.has_entered()) {
          warp.lanes[number].entered = log_.entered(warp.pixels[pixel].first, warp.pixels[pixel].second);
        }
        if (shares()) {
          warp.lanes[number].meets = log_.meets(warp.pixels[pixel].first, warp.pixels[pixel].second);
        }
        lanes.push_back(number);
      }
    }
    begin_shader(node, warp, lanes);
  }

  void read_lines(const NaiveRecord& record, std::deque<LookUp>& to) const {
    for (std::uint64_t line = record.address / unit_; line <= (record.address + record.bytes - 1) / unit_;
         ++line) {
      to.push_back({record.kind, line});
    }
  }

  void begin_shader(Node& node, Warp& warp, const std::vector<std::size_t>& lanes) {
    Phase phase;
    phase.began = node.cycle;
    phase.lanes = lanes;
    NaiveMost most;
    std::deque<LookUp> reads;
    for (const std::size_t number : lanes) {
      Lane& lane = warp.lanes[number];
      const std::optional<std::uint32_t> before = std::exchange(lane.ray, std::nullopt);
      lane.goes_back = false;
      StepCounts steps;
      bool asks = false;
      while (!lane.ray && lane.next < lane.words.size()) {
        const std::uint32_t* const word = &lane.words[lane.next];
        program_.count(word, steps);
        if (step_of(*word) == Step::ray) {
          lane.ray = operand_of(*word);
          lane.rays = lane.next_ray++;
        } else if (step_of(*word) == Step::shade || step_of(*word) == Step::any_hit) {
          read_lines(program_.material(operand_of(*word)), reads);
        } else if (step_of(*word) == Step::texel) {
          read_lines(program_.texel(operand_of(*word), word[1]), reads);
        }
        lane.next += step_words(word);
        // The ray goes on with the answer to the last hit that it was asked about, which a texel may decide.
        const bool asked = std::exchange(asks, step_of(*word) == Step::any_hit);
        const Step follows = lane.next == lane.words.size() ? Step::ray : step_of(lane.words[lane.next]);
        const bool answered = asks ? follows != Step::texel : asked && step_of(*word) == Step::texel;
        if (answered && follows != Step::any_hit) {
          lane.ray = before;
          lane.goes_back = true;
        }
      }
      if (!lane.ray && machine_.pixels == Pixels::written) {
        ++steps.pixels;
        const std::size_t pixel = warp.turn * machine_.simt.lanes + number;
        const auto [x, y] = warp.pixels[pixel];
        add_write(warp, layout_.address(memory::RecordKind::pixel, std::uint64_t{y} * log_.width + x));
      }
      most.lane(steps);
      sim::merge(node.statistics.steps, steps);
    }
    for (const LookUp& read : reads) {
      const auto known = [&](const LookUp& other) { return other.line == read.line; };
      if (std::none_of(phase.reading.left.begin(), phase.reading.left.end(), known)) {
        phase.reading.left.push_back(read);
      }
    }
    phase.cycles = most.cycles(ticks_, period_);
    phase.computed = phase.cycles.all() == 0;
    warp.phase = phase;
    warp.does = Warp::Does::phase;
  }

  // One write for each pixel; they are joined when they are posted.
  void add_write(Warp& warp, memory::Address address) const {
    warp.writes.push_back({0, address, machine_.layout.pixel_bytes});
  }
  void join_writes(Warp& warp) const {
    std::sort(warp.writes.begin(), warp.writes.end(),
              [](const auto& a, const auto& b) { return a.address < b.address; });
    std::deque<memory::Transaction> joined;
    for (const memory::Transaction& write : warp.writes) {
      const std::uint32_t line = machine_.cache.cache.line;
      if (!joined.empty() && joined.back().address + joined.back().bytes == write.address &&
          joined.back().address / line == (write.address + write.bytes - 1) / line) {
        joined.back().bytes += write.bytes;
      } else {
        joined.push_back(write);
      }
    }
    warp.writes = joined;
  }

  // What follows a phase that is done, as often as it takes no time.
  void advance(Node& node, std::size_t number) {
    Warp& warp = node.warps[number];
    for (;;) {
      if (warp.does == Warp::Does::left_unit) {
        end_trace(node, warp);
      } else if (warp.does == Warp::Does::written) {
        go_on(node, warp);
      } else if (warp.does == Warp::Does::phase && warp.phase.computed && warp.phase.reading.done()) {
        if (warp.phase.round) {
          end_round(node, warp);
        } else {
          end_shader(node, number);
        }
      } else {
        return;
      }
    }
  }

  void end_shader(Node& node, std::size_t number) {
    Warp& warp = node.warps[number];
    if (warp.writes.empty()) {
      go_on(node, warp);
      return;
    }
    join_writes(warp);
    warp.does = Warp::Does::write;
    if (!node.writers.empty() || !takes_entries(node, warp)) {
      node.writers.push_back({number});
    }
  }
  // Posts what the first of those that wait writes; whether that is all.
  bool writes_first(Node& node) const {
    const Node::Writer& first = node.writers.front();
    if (!first.group) {
      return takes_entries(node, node.warps[first.warp]);
    }
    if (!takes_entry(node, {0, first.line, unit_})) {
      return false;
    }
    --first.group->unposted;
    return true;
  }
  // Posts the writes of a warp for which there is room; whether these are all.
  bool takes_entries(Node& node, Warp& warp) const {
    while (!warp.writes.empty()) {
      if (!takes_entry(node, warp.writes.front())) {
        return false;
      }
      warp.writes.pop_front();
      ++node.statistics.writes;
    }
    warp.does = Warp::Does::written;
    return true;
  }
  bool takes_entry(Node& node, const memory::Transaction& write) const {
    WriteEntry& entry = node.buffer[node.next_entry];
    if (entry.posted == node.cycle || entry.end > engine_.now()) {
      return false;
    }
    entry = {node.cycle, never};
    node.posted.push_back(node.next_entry);
    node.next_entry = (node.next_entry + 1) % node.buffer.size();
    node.to_post.push_back(write);
    return true;
  }

  [[nodiscard]] static bool holds_ray(const Warp& warp) {
    return std::any_of(warp.lanes.begin(), warp.lanes.end(),
                       [](const Lane& lane) { return lane.ray.has_value(); });
  }
  [[nodiscard]] bool is_last_turn(const Warp& warp) const {
    return (warp.turn + 1) * machine_.simt.lanes >= warp.pixels.size();
  }
  static void count_warp(Node& node, const Warp& warp) {
    node.counts.longest_warp = std::max(node.counts.longest_warp, node.cycle - warp.reached);
  }

  void go_on(Node& node, Warp& warp) {
    if (holds_ray(warp)) {
      begin_trace(node, warp);
    } else if (!is_last_turn(warp)) {
      ++warp.turn;
      begin_turn(node, warp);
    } else {
      count_warp(node, warp);
      warp.does = Warp::Does::ask;
    }
  }

  void begin_trace(Node& node, Warp& warp) {
    std::optional<std::pair<std::uint32_t, std::size_t>> least;
    const auto order = [](const Lane& lane) {
      return std::pair(bounce_of(*lane.ray), ray_number_of(*lane.ray));
    };
    for (const Lane& lane : warp.lanes) {
      if (lane.ray && (!least || order(lane) < *least)) {
        least = order(lane);
      }
    }
    warp.trace_began = node.cycle;
    bool any = false;
    for (Lane& lane : warp.lanes) {
      lane.picked = lane.ray && (machine_.simt.reconverge == Reconverge::any || order(lane) == *least);
      lane.visits.clear();
      lane.at = 0;
      if (lane.picked && shares()) {
        begin_shared(node, lane);
        any = any || lane.away;
      } else if (lane.picked) {
        NaiveRay ray = program_.visits(ray_kind_of(*lane.ray), lane.words, lane.next, node.statistics.steps,
                                       lane.entered, stack_place(node, warp, lane), lane.way);
        lane.visits = std::move(ray.visits);
        node.counts.fills +=
            std::count_if(lane.visits.begin(), lane.visits.end(), [](const NaiveVisit& visit) {
              return visit.record && visit.record->kind == memory::RecordKind::node &&
                     visit.record->test == NaiveTest::none;
            });
        lane.last_spills = std::move(ray.spills);
        if (has_unit()) {
          std::erase_if(lane.visits, [](const NaiveVisit& visit) { return !visit.record; });
        }
        any = any || !lane.visits.empty();
        lane.trace_began = node.cycle;
        lane.in = Lane::In::done;
        lane.away = has_unit() && !lane.visits.empty();
      }
    }
    if (!any) {
      end_trace(node, warp);
    } else if (has_unit()) {
      warp.does = Warp::Does::traces;
      send_away(node, warp);
    } else {
      begin_round(node, warp);
    }
  }

  // The lane's ray begins with the root, if it meets that.
  void begin_shared(Node& node, Lane& lane) const {
    while (lane.next < lane.words.size() && NaiveSimtLog::is_visit(step_of(lane.words[lane.next]))) {
      lane.next += step_words(&lane.words[lane.next]);
    }
    const auto ray = std::make_shared<NaiveSharedRay>();
    ray->meets = lane.meets.first(lane.meets.front());
    ray->shadow = ray_kind_of(*lane.ray) == RayKind::shadow;
    ray->began = lane.trace_began = node.cycle;
    lane.meets = lane.meets.subspan(ray->meets.size());
    lane.shared = NaiveSharedLane(ray, {0, 0, 1});
    lane.in = Lane::In::done;
    lane.away = ray->meets.size() > 1 && next_shared(node, lane);
    lane.at = 0;
  }

  // Rays of a warp go to the pool or wait for the unit together.
  void send_away(Node& node, Warp& warp) const {
    const auto group = std::make_shared<Group>();
    group->waits = node.cycle;
    for (Lane& lane : warp.lanes) {
      if (lane.away) {
        lane.in = Lane::In::none;
      }
      lane.place = lane.number;
      if (!sorts() && (lane.away || shares())) {
        group->lanes.push_back(&lane);  // others may help
      } else if (lane.away) {
        node.pool.push_back(&lane);
      }
    }
    if (!sorts()) {
      auto before = node.ready.end();  // those of one cycle are served in the order of warps
      while (before != node.ready.begin() && (*(before - 1))->waits == node.cycle &&
             (*(before - 1))->lanes.front()->warp > group->lanes.front()->warp) {
        --before;
      }
      node.ready.insert(before, group);
    }
  }

  // Nodes of a cluster have their places one after the other, from a line on each; so have lanes of a node.
  [[nodiscard]] memory::Address stack_place(const Node& node, const Warp& warp, const Lane& lane) const {
    const auto number = static_cast<std::uint64_t>(&node - nodes_.data()) % machine_.nodes;
    const auto of_warp = static_cast<std::uint64_t>(&warp - node.warps.data());
    const auto up = [&](std::uint64_t bytes) {
      const std::uint64_t line = machine_.cache.cache.line;
      return (bytes + line - 1) / line * line;
    };
    const std::uint64_t each = program_.stack_bytes();
    return up(layout_.address(memory::RecordKind::pixel, std::uint64_t{log_.width} * log_.height)) +
           number * up(each * machine_.simt.lanes * machine_.simt.warps) +
           (of_warp * machine_.simt.lanes + lane.number) * each;
  }

  void end_trace(Node& node, Warp& warp) {
    std::vector<std::size_t> lanes;
    for (Lane& lane : warp.lanes) {
      lane.in = Lane::In::none;
      if (std::exchange(lane.picked, false)) {
        lanes.push_back(lane.number);
      }
    }
    begin_shader(node, warp, lanes);
  }

  // ---- warps that trace themselves

  void begin_round(Node& node, Warp& warp) {
    Phase phase;
    phase.began = node.cycle;
    phase.round = true;
    NaiveMost most;
    std::vector<NaiveRecord> accesses;
    for (Lane& lane : warp.lanes) {
      if (!lane.picked || lane.at == lane.visits.size()) {
        continue;
      }
      phase.lanes.push_back(lane.number);
      const NaiveVisit& visit = lane.visits[lane.at];
      most.lane(visit.steps);
      if (!visit.record) {
        continue;
      }
      ++node.counts.records;
      const auto same = std::find_if(accesses.begin(), accesses.end(), [&](const NaiveRecord& other) {
        return other.address == visit.record->address;
      });
      if (same == accesses.end() || machine_.rt.coalesce == RtCoalesce::none) {
        accesses.push_back(*visit.record);
        ++node.counts.accesses;
      } else {
        same->bytes = std::max(same->bytes, visit.record->bytes);
      }
    }
    for (const NaiveRecord& access : accesses) {
      read_lines(access, phase.reading.left);
    }
    phase.cycles = most.cycles(ticks_, period_);
    phase.computed = phase.cycles.all() == 0;
    warp.phase = phase;
    warp.does = Warp::Does::phase;
  }

  void end_round(Node& node, Warp& warp) {
    bool over = true;
    for (const std::size_t number : warp.phase.lanes) {
      Lane& lane = warp.lanes[number];
      if (++lane.at < lane.visits.size()) {
        over = false;
      } else if (lane.visits.front().record) {
        count_ray(node, warp.trace_began, lane.goes_back);
      }
    }
    if (over) {
      end_trace(node, warp);
    } else {
      begin_round(node, warp);
    }
  }

  // ---- step 8

  void look_up_lines(std::uint32_t number) {
    Node& node = nodes_[number];
    if (node.finished) {
      return;
    }
    for (std::uint32_t port = 0; port < machine_.simt.ports; ++port) {
      Reading* const reading = next_reading(node);
      if (reading == nullptr) {
        look_up_prefetch(number);
        continue;
      }
      const LookUp wanted = reading->left.front();
      const auto line = look_up(number, wanted);
      if (!line) {
        ++node.counts.full_cycles;
        break;
      }
      node.looked_up = node.looked_up.value_or(wanted.kind);
      reading->lines.push_back(line);
      reading->left.pop_front();
      node.stuck.reset();
      if (reading == node.sending.get() && reading->left.empty()) {
        node.sending = nullptr;
      }
    }
  }

  // What the next line is looked up for; null: nothing.
  Reading* next_reading(Node& node) {
    if (node.stuck) {
      return &node.warps[*node.stuck].phase.reading;
    }
    if (!node.sending) {
      node.sending = next_access(node);
    }
    if (node.sending) {
      return node.sending.get();
    }
    for (std::size_t number = 0; number < node.warps.size(); ++number) {
      const Warp& warp = node.warps[number];
      if (warp.does == Warp::Does::phase && !warp.phase.reading.left.empty() &&
          (!node.stuck || warp.phase.began < node.warps[*node.stuck].phase.began)) {
        node.stuck = number;  // unless the look-up succeeds
      }
    }
    return node.stuck ? &node.warps[*node.stuck].phase.reading : nullptr;
  }

  static Lane* wanting_lane(Node& node, std::size_t slot) {
    if (node.unit[slot]) {
      for (Lane* const lane : node.unit[slot]->lanes) {
        if (lane->in == Lane::In::wants) {
          return lane;
        }
      }
    }
    return nullptr;
  }
  // The treelet picked last if a lane wants a record of it, else that of most lanes, the lowest of equal
  // ones; its oldest warp's lowest lane, and the slot of the warp.
  static std::pair<Lane*, std::size_t> pick_by_treelet(Node& node) {
    std::map<std::uint32_t, std::size_t> lanes;
    for_lanes_in_unit(node, [&](const auto&, Lane& lane) {
      if (lane.in == Lane::In::wants) {
        ++lanes[lane.visits[lane.at].treelet];
      }
    });
    if (lanes.empty()) {
      return {nullptr, 0};
    }
    if (!node.picked_treelet || !lanes.contains(*node.picked_treelet)) {
      node.picked_treelet = std::max_element(lanes.begin(), lanes.end(), [](const auto& a, const auto& b) {
                              return a.second < b.second;
                            })->first;
    }
    std::pair<Lane*, std::size_t> picked = {nullptr, 0};
    for (std::size_t slot = 0; slot < node.unit.size(); ++slot) {
      if (!node.unit[slot]) {
        continue;
      }
      for (Lane* const lane : node.unit[slot]->lanes) {
        if (lane->in == Lane::In::wants && lane->visits[lane->at].treelet == *node.picked_treelet &&
            (picked.first == nullptr || node.unit[slot]->entered < node.unit[picked.second]->entered)) {
          picked = {lane, slot};
        }
      }
    }
    return picked;
  }
  std::optional<std::size_t> pick_slot(Node& node) const {
    std::optional<std::size_t> oldest;
    for (std::size_t i = 0; i < node.unit.size(); ++i) {
      const std::size_t slot = (node.next_slot + i) % node.unit.size();
      if (wanting_lane(node, slot) == nullptr) {
        continue;
      }
      if (machine_.rt.scheduler == RtScheduler::round_robin ||
          (machine_.rt.scheduler == RtScheduler::greedy && node.unit[slot] == node.picked_group)) {
        return slot;
      }
      if (!oldest || node.unit[slot]->entered < node.unit[*oldest]->entered) {
        oldest = slot;
      }
    }
    return oldest;
  }

  std::shared_ptr<Reading> next_access(Node& node) const {
    std::pair<Lane*, std::size_t> lane_and_slot = {nullptr, 0};
    if (machine_.rt.scheduler == RtScheduler::treelet) {
      lane_and_slot = pick_by_treelet(node);
    } else if (const std::optional<std::size_t> slot = pick_slot(node)) {
      lane_and_slot = {wanting_lane(node, *slot), *slot};
    }
    if (lane_and_slot.first == nullptr) {
      return nullptr;
    }
    const std::shared_ptr<Group> picked = node.unit[lane_and_slot.second];
    node.picked_group = picked;
    node.next_slot = (lane_and_slot.second + 1) % node.unit.size();
    Lane& first = *lane_and_slot.first;
    auto access = std::make_shared<Reading>();
    NaiveRecord longest = first.record();
    for_lanes_in_unit(node, [&](const auto& group, Lane& lane) {
      const bool joins = machine_.rt.coalesce == RtCoalesce::unit ||
                         (machine_.rt.coalesce == RtCoalesce::warp && group == picked);
      if (&lane == &first ||
          (joins && lane.in == Lane::In::wants && lane.record().address == longest.address)) {
        longest.bytes = std::max(longest.bytes, lane.record().bytes);
        lane.in = Lane::In::reads;
        lane.access = access;
        ++node.counts.records;
      }
    });
    ++node.counts.accesses;
    read_lines(longest, access->left);
    return access;
  }

  static NaiveLine line_of(const Node& node, const LookUp& wanted) {
    return {
        node.caches.size() > 1 ? processors::walk::split_cache_of[static_cast<std::size_t>(wanted.kind)] : 0,
        wanted.line};
  }
  [[nodiscard]] bool holds(const Node& node, const NaiveLine& line) const {
    const std::uint64_t sectors = machine_.cache.cache.line / unit_;
    return node.caches[line.first].holds(line.second / sectors, line.second % sectors);
  }
  void refer(Node& node, const NaiveLine& line) const {
    const std::uint64_t sectors = machine_.cache.cache.line / unit_;
    (void)node.caches[line.first].look_up(line.second / sectors, line.second % sectors);
  }
  static Register* under_way(Node& node, const NaiveLine& line) {
    for (Register& one : node.registers) {
      if (one.line && one.number == line) {
        return &one;
      }
    }
    return nullptr;
  }
  static Register* free_register(Node& node) {
    const auto free = std::find_if(node.registers.begin(), node.registers.end(),
                                   [](const Register& one) { return !one.line; });
    return free == node.registers.end() ? nullptr : &*free;
  }

  void look_up_prefetch(std::uint32_t number) {
    Node& node = nodes_[number];
    const auto first = node.prefetch.next();
    if (!first || holds(node, first->line) || under_way(node, first->line) != nullptr) {
      return;
    }
    if (free_register(node) == nullptr) {
      node.prefetch.no_register();
      return;
    }
    refer(node, first->line);
    node.prefetch.issued(first->line);
    ask_behind_cache(number, first->line)->wanted = false;
  }

  // Null: there is no register.
  std::shared_ptr<Line> look_up(std::uint32_t number, const LookUp& wanted) {
    using Found = NaivePrefetch::Found;
    Node& node = nodes_[number];
    const NaiveLine which = line_of(node, wanted);
    if (Register* const one = under_way(node, which)) {
      refer(node, which);
      node.prefetch.looked_up(which, Found::joined);
      one->line->wanted = true;
      ++hits_of(node.statistics, wanted.kind);
      ++node.counts.joined;
      return one->line;
    }
    if (holds(node, which)) {
      const auto line = std::make_shared<Line>();
      refer(node, which);
      node.prefetch.looked_up(which, Found::hit);
      ++hits_of(node.statistics, wanted.kind);
      line->there = node.cycle + std::max<Cycle>(1, machine_.cache.hit_cycles);
      node.coming.push_back(line);
      return line;
    }
    if (free_register(node) == nullptr) {
      return nullptr;
    }
    refer(node, which);
    node.prefetch.looked_up(which, Found::missed);
    ++misses_of(node.statistics, wanted.kind);
    return ask_behind_cache(number, which);
  }

  std::shared_ptr<Line> ask_behind_cache(std::uint32_t number, const NaiveLine& which) {
    Node& node = nodes_[number];
    const auto line = std::make_shared<Line>();
    Register* const free = free_register(node);
    *free = {line, which, node.cycle};
    if (!node.second.empty()) {
      const bool hit = node.second.front().look_up(which.second, 0);
      ++(hit ? node.second_counts.hits : node.second_counts.misses);
      if (hit) {
        const sim::Ticks hit_time = machine_.l2.clock.value_or(machine_.clock).cycles(machine_.l2.hit_cycles);
        line->there = std::max(node.cycle + 1, cycle_at_or_after(engine_.now() + hit_time));
        return line;
      }
    }
    line->left = true;
    if (replicated()) {
      arrives(node, *free, processors::walk::LocalMemory(machine_.local).read(unit_, engine_.now()));
    } else {
      const auto port = static_cast<std::uint32_t>(free - node.registers.data());
      interconnects_[number / machine_.nodes]->read(
          {number % machine_.nodes * machine_.simt.mshrs + port, which.second * unit_, unit_});
    }
    return line;
  }

  void arrives(Node& node, const Register& at, const memory::Service& service) {
    end_ = std::max(end_, service.done);
    at.line->there = std::max(at.asked + 1, cycle_at_or_after(service.done));
    node.parts.wait_interconnect += service.wait_interconnect;
    node.parts.transfer += service.transfer;
    node.parts.wait_bank += service.wait_bank;
    node.parts.bank += service.bank;
  }

  // ---- writes, and where the cycle went

  void end_cycle(std::uint32_t number) {
    Node& node = nodes_[number];
    for (; !node.to_post.empty(); node.to_post.pop_front()) {
      const memory::Transaction& write = node.to_post.front();
      interconnects_[number / machine_.nodes]->write(
          {number % machine_.nodes * machine_.simt.mshrs, write.address, write.bytes});
    }
    if (node.finished) {
      return;
    }
    spend_cycle(node);
    for (const Warp& warp : node.warps) {
      if (warp.has_packet()) {
        count_lanes(node, warp);
      }
    }
    for (const Register& one : node.registers) {
      node.counts.line_cycles += one.line ? 1 : 0;
    }
    for (const std::shared_ptr<Group>& slot : node.unit) {
      node.counts.unit_cycles += slot ? 1 : 0;
    }
    ++node.cycle;
    post(EventClass::step, node.cycle * period_, number);
  }

  void spend_cycle(Node& node) const {
    const std::optional<Activity> activity = activity_of_cycle(node);
    if (activity) {
      spend(node, *activity, period_);
    } else {
      ++node.memory_cycles;
    }
  }
  // Null: memory.
  static std::optional<Activity> activity_of_cycle(Node& node) {
    const Phase* computes = nullptr;
    for (const Warp& warp : node.warps) {
      if (warp.does == Warp::Does::phase && warp.phase.computes() &&
          (computes == nullptr || *warp.phase.slot < *computes->slot)) {
        computes = &warp.phase;
      }
    }
    if (computes != nullptr) {
      const Cycle into = node.cycle - *computes->slot;
      return into < computes->cycles.traversal                                   ? Activity::traversal
             : into < computes->cycles.traversal + computes->cycles.intersection ? Activity::intersection
                                                                                 : Activity::shading;
    }
    if (node.looked_up) {
      const memory::RecordKind kind = *node.looked_up;
      return kind == memory::RecordKind::primitive ? Activity::intersection
             : kind == memory::RecordKind::node || kind == memory::RecordKind::transform ||
                     kind == memory::RecordKind::list
                 ? Activity::traversal
                 : Activity::shading;
    }
    bool second = false;
    for (const Register& one : node.registers) {
      if (one.line && one.line->wanted && one.line->left) {
        return std::nullopt;
      }
      second = second || (one.line && one.line->wanted);
    }
    if (second || !node.coming.empty()) {
      return Activity::cache_access;
    }
    Cycle box = never;
    Cycle primitive = never;
    for_lanes_in_unit(node, [&](const auto&, Lane& lane) {
      if (lane.in == Lane::In::tests) {
        Cycle& first = of_box(lane) ? box : primitive;
        first = std::min(first, lane.ends);
      }
    });
    if (box != never || primitive != never) {
      return box <= primitive ? Activity::traversal : Activity::intersection;
    }
    const auto any = [&](Warp::Does does) {
      return std::any_of(node.warps.begin(), node.warps.end(),
                         [does](const Warp& warp) { return warp.does == does; });
    };
    return !node.writers.empty()              ? Activity::queue_full_wait
           : any(Warp::Does::wait_for_packet) ? Activity::dispatch_wait
                                              : Activity::idle;
  }

  // All of its rays, which are not sorted.
  [[nodiscard]] bool waits_for_unit(const Warp& warp) const {
    return !sorts() && std::any_of(warp.lanes.begin(), warp.lanes.end(),
                                   [](const Lane& lane) { return lane.away && lane.in == Lane::In::none; });
  }
  void count_lanes(Node& node, const Warp& warp) const {
    processors::walk::SimtCounts& counts = node.counts;
    const auto waits_for = [&](const Reading& reading) -> std::int64_t& {
      return !reading.left.empty()        ? counts.lanes_scheduler
             : reading.waits_for_memory() ? counts.lanes_memory
                                          : counts.lanes_cache;
    };
    for (const Lane& lane : warp.lanes) {
      if (lane.in == Lane::In::wants) {
        ++counts.lanes_scheduler;
      } else if (lane.in == Lane::In::reads) {
        ++waits_for(*lane.access);
      } else if (lane.works()) {
        ++(of_box(lane) ? counts.lanes_box : counts.lanes_primitive);
      } else if (!lane.pixel) {
        ++counts.lanes_empty;
      } else if (warp.does == Warp::Does::phase && std::find(warp.phase.lanes.begin(), warp.phase.lanes.end(),
                                                             lane.number) != warp.phase.lanes.end()) {
        ++(warp.phase.computes()     ? counts.lanes_shading
           : warp.phase.wants_slot() ? counts.lanes_slot
                                     : waits_for(warp.phase.reading));
      } else if ((lane.away && lane.in == Lane::In::none) || (lane.picked && waits_for_unit(warp))) {
        ++counts.lanes_unit;
      } else {
        ++counts.lanes_held;
      }
    }
  }

  // The largest remainders, the first of equal ones, get what is left.
  void divide_memory(Node& node) const {
    using Wide = __int128;
    const Wide all = Wide{node.memory_cycles} * period_;
    const std::array<sim::Ticks, 4> parts = {node.parts.wait_interconnect, node.parts.transfer,
                                             node.parts.wait_bank, node.parts.bank};
    const std::array<Activity, 4> activities = {Activity::interconnect_wait, Activity::transfer,
                                                Activity::bank_wait, Activity::bank_access};
    Wide sum = 0;
    for (const sim::Ticks part : parts) {
      sum += part;
    }
    if (sum == 0) {
      spend(node, Activity::transfer, static_cast<sim::Ticks>(all));
      return;
    }
    Wide left = all;
    std::vector<std::pair<Wide, std::size_t>> remainders;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Wide share = all * parts[i] / sum;
      spend(node, activities[i], static_cast<sim::Ticks>(share));
      left -= share;
      remainders.emplace_back(-(all * parts[i] % sum), i);
    }
    std::sort(remainders.begin(), remainders.end());
    for (std::size_t i = 0; left > 0; ++i, --left) {
      spend(node, activities[remainders[i].second], 1);
    }
  }

  const WorkLog& log_;
  MachineConfig machine_;
  memory::Layout layout_;
  NaiveSimtLog program_;
  StepTicks ticks_;
  sim::Ticks period_;
  std::uint32_t unit_;
  PacketList packets_;
  processors::node::Host host_;
  sim::Engine engine_;
  std::vector<Node> nodes_;
  std::vector<Client> clients_;
  std::vector<std::unique_ptr<memory::Interconnect>> interconnects_;
  sim::Ticks end_ = 0;
};

}  // namespace

MachineResult naive_simt(const WorkLog& log, const MachineConfig& config) {
  return NaiveSimt(log, config).run();
}

}  // namespace marti::test
