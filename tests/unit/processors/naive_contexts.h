// A second implementation of nodes with contexts and prefetching, written for plainness: each packet is
// flattened into single actions, each action is an event of its own, caches of both levels are lists. Only
// the interconnect, or the distributed memory, the packets and the host are the real ones. LRU and FIFO
// replacement.
#pragma once

#include <algorithm>
#include <deque>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "processors/node/memory_system.h"
#include "processors/replay/replay.h"
#include "tests/support/naive_counts.h"
#include "tests/support/naive_program.h"

namespace marti::test {

class NaiveContexts final : public sim::EventHandler {
 public:
  /// `counts`, where given, is told of every reference and prefetch.
  NaiveContexts(const processors::program::WorkLog& log, const processors::machine::MachineConfig& machine,
                NaiveCounts* counts = nullptr)
      : log_(log),
        machine_(machine),
        program_(log, machine),
        packets_(log.width, log.height, machine.packets),
        host_(machine.host, packets_.size(), machine.all_nodes()),
        cached_(machine.cache.organisation != processors::machine::CacheOrganisation::none),
        unit_(program_.unit()),
        ports_(machine.ports_of_node()),
        counted_(counts),
        nodes_(machine.all_nodes()) {
    for (Node& node : nodes_) {
      node.contexts.resize(machine.contexts);
      node.flights.resize(ports_);
      node.buffer.assign(machine.write_buffer, 0);
    }
    for (std::uint8_t c = 0; c < 6; ++c) {
      engine_.attach(c, *this);
    }
    clients_.resize(machine.clusters);
    for (std::uint32_t cluster = 0; cluster < machine.clusters; ++cluster) {
      clients_[cluster].all = this;
      clients_[cluster].first = cluster * machine.nodes;
      const std::uint32_t ports = machine.nodes * ports_;
      interconnects_.push_back(processors::node::make_memory_system(
          machine, {engine_, clients_[cluster], 2, cluster * ports, ports, 5}));
    }
  }

  processors::replay::MachineResult run() {
    for (std::uint32_t context = 0; context < machine_.contexts; ++context) {
      for (std::uint32_t node = 0; node < nodes_.size(); ++node) {
        engine_.post(sim::Event::make(0, 1, context * machine_.all_nodes() + node));
      }
    }
    engine_.run(std::numeric_limits<std::uint64_t>::max());
    processors::replay::MachineResult result;
    result.end = end_;
    result.host = host_.statistics();
    for (Node& node : nodes_) {
      node.statistics.time[static_cast<std::size_t>(processors::cost::Activity::idle)] =
          end_ - node.statistics.finish;
      node.counts.useless += static_cast<std::int64_t>(node.unasked.size());
      result.nodes.push_back(node.statistics);
      result.contexts.nodes.push_back(node.counts);
      if (has_second_level()) {
        result.l2.caches.push_back(node.second_level);
      }
    }
    for (const auto& interconnect : interconnects_) {
      result.clusters.push_back({interconnect->statistics(), interconnect->bank_statistics()});
    }
    return result;
  }

  void handle(const sim::Event& event) override {
    const std::uint32_t component = event.component();
    switch (event.event_class()) {
      case 0:
        if (event.sequence() == 0) {
          act(component);
        } else if (nodes_[component].waiting) {
          wake(component);
        }
        break;
      case 1:
        ask(component % machine_.all_nodes(), component < machine_.all_nodes()
                                                  ? nodes_[component].last.value_or(0)
                                                  : component / machine_.all_nodes());
        break;
      case 2:
        interconnect_of(component / ports_).reply(component % (machine_.nodes * ports_));
        break;
      case 3:
        refer(component);
        break;
      case 4:
        write(component);
        break;
      default:
        interconnect_of(component / ports_).proceed(component % (machine_.nodes * ports_), event.sequence());
    }
  }

 private:
  static constexpr sim::Ticks never = std::numeric_limits<sim::Ticks>::max();

  using Action = NaiveAction;
  struct Flight {
    memory::Service service;
    sim::Ticks done = 0;
    std::uint64_t line = 0;
    bool prefetch = false;
    bool second_level = false;  // it brings the line from there
  };
  struct Context {
    std::vector<Action> actions;
    std::size_t next = 0;
    sim::Ticks ready = never;
    std::shared_ptr<Flight> flight;  // what it waits for; null: the host
    Action waits_for;                // the reference that it waits to make
    std::uint32_t ray = 0;           // of its packet's last step
  };
  using Key = std::pair<int, std::uint64_t>;  // which cache, which line
  struct Node {
    std::vector<Context> contexts;
    std::optional<std::uint32_t> last;  // context worked on last
    bool waiting = true;
    bool stalled = false;  // waits for a write whose end is not known yet
    sim::Ticks since = 0;
    sim::Ticks time = 0;
    std::uint32_t finished = 0;
    std::deque<sim::Ticks> buffer;
    std::vector<std::shared_ptr<Flight>> flights;    // by port
    std::map<Key, std::shared_ptr<Flight>> brought;  // the transaction that brought a line last
    std::map<std::pair<int, std::uint64_t>, std::list<std::uint64_t>> sets;  // newest first
    std::set<Key> unasked;
    std::map<std::uint64_t, std::list<std::uint64_t>> second_sets;  // of the second level
    processors::cost::NodeStatistics statistics;
    processors::walk::ContextCounts counts;
    memory::CacheCounters second_level;
  };
  struct Client final : memory::InterconnectClient {
    NaiveContexts* all = nullptr;
    std::uint32_t first = 0;
    void read_done(std::uint32_t port, const memory::Service& service) override {
      all->read_done(first + port / all->ports_, port % all->ports_, service);
    }
    void write_done(std::uint32_t port, sim::Ticks done) override {
      Node& node = all->nodes_[first + port / all->ports_];
      all->end_ = std::max(all->end_, done);
      const auto oldest = std::find(node.buffer.begin(), node.buffer.end(), never);
      *oldest = done;
      if (std::exchange(node.stalled, false)) {
        all->write(first + port / all->ports_);
      }
    }
  };

  memory::Interconnect& interconnect_of(std::uint32_t node) { return *interconnects_[node / machine_.nodes]; }

  // ---- the processor

  void spend(Node& node, processors::cost::Activity activity, sim::Ticks time) {
    node.statistics.time[static_cast<std::size_t>(activity)] += time;
  }

  void ask(std::uint32_t number, std::uint32_t which) {
    Node& node = nodes_[number];
    Context& context = node.contexts[which];
    const auto grant = host_.next(number, engine_.now());
    if (!grant) {
      if (++node.finished == machine_.contexts) {
        node.statistics.finish = engine_.now();
        end_ = std::max(end_, engine_.now());
        return;
      }
      if (!node.waiting && which == *node.last) {
        pause(number);
      }
      return;
    }
    ++node.statistics.packets;
    context.actions = program_.actions_of(packets_[grant->packet], context.ray);
    context.next = 0;
    context.flight = nullptr;
    set_ready(number, which, grant->start);
    if (!node.waiting && which == *node.last) {
      pause(number);
    }
  }

  void set_ready(std::uint32_t number, std::uint32_t which, sim::Ticks time) {
    nodes_[number].contexts[which].ready = time;
    engine_.post(sim::Event::make(time, 0, number, 1 + which));
  }

  void act(std::uint32_t number) {
    Node& node = nodes_[number];
    Context& context = node.contexts[*node.last];
    if (context.next == context.actions.size()) {
      engine_.post(sim::Event::make(node.time, 1, number));
      return;
    }
    const Action& action = context.actions[context.next];
    switch (action.what) {
      case Action::What::compute:
        go_on(number, action.activity, action.time);
        break;
      case Action::What::refer:
      case Action::What::children:
        engine_.post(sim::Event::make(node.time, 3, number));
        break;
      case Action::What::write:
        engine_.post(sim::Event::make(node.time, 4, number));
        break;
    }
  }

  // An action of the context at work is done.
  void go_on(std::uint32_t number, processors::cost::Activity activity, sim::Ticks time) {
    Node& node = nodes_[number];
    spend(node, activity, time);
    node.time += time;
    ++node.contexts[*node.last].next;
    engine_.post(sim::Event::make(node.time, 0, number));
  }

  void refer(std::uint32_t number) {
    Node& node = nodes_[number];
    Context& context = node.contexts[*node.last];
    const Action action = context.actions[context.next];
    if (action.what == Action::What::children) {
      prefetch_children(number, action.branch);
      go_on(number, processors::cost::Activity::traversal, 0);
      return;
    }
    const Key key = key_of(action.kind, action.address / unit_);
    if (const auto flight = cached_ ? under_way(node, key) : nullptr) {
      ++(flight->prefetch ? node.counts.late : node.counts.joined);
      context.flight = flight;
      context.waits_for = action;
      context.ready = never;
      if (flight->done != never) {
        set_ready(number, *node.last, flight->done);
      }
      pause(number);
      return;
    }
    const bool hit = cached_ && in_cache(node, key);
    if (counted_ != nullptr) {
      counted_->refer(number, static_cast<std::size_t>(key.first), action, key.second, hit);
    }
    if (hit) {
      look_up(node, key);
      ++node.statistics.references.hits[static_cast<std::size_t>(action.kind)];
      go_on(number, processors::cost::Activity::cache_access, program_.ticks().hit);
      return;
    }
    ++node.statistics.references.misses[static_cast<std::size_t>(action.kind)];
    if (cached_) {
      look_up(node, key);
      if (second_level_has(node, key.second)) {
        if (counted_ != nullptr) {
          counted_->second_level_hit(action);
        }
        go_on(number, processors::cost::Activity::cache_access,
              machine_.l2.clock.value_or(machine_.clock).cycles(machine_.l2.hit_cycles));
        return;
      }
    }
    const std::uint32_t bytes = cached_ ? unit_ : action.bytes;
    if (machine_.placement == processors::machine::Placement::replicated) {
      const processors::machine::LocalMemoryConfig& local = machine_.local;
      const sim::Ticks transfer =
          local.clock.cycles(local.cycles_per_beat) * ((bytes + local.width - 1) / local.width);
      spend(node, processors::cost::Activity::transfer, transfer);
      node.time += transfer;
      if (counted_ != nullptr) {
        counted_->wait(action, transfer + local.clock.cycles(local.access_cycles));
      }
      go_on(number, processors::cost::Activity::bank_access, local.clock.cycles(local.access_cycles));
      return;
    }
    ++context.next;
    context.waits_for = action;
    context.ready = never;
    context.flight = std::make_shared<Flight>();
    context.flight->line = key.second;
    if (cached_) {
      node.brought[key] = context.flight;
    }
    issue(number, *node.last, context.flight, cached_ ? action.address / unit_ * unit_ : action.address,
          bytes);
    if (machine_.prefetch.next_line) {
      const memory::Address next = (action.address / unit_ + 1) * unit_;
      if (next < program_.layout().base(action.kind) + program_.layout().section_bytes(action.kind)) {
        prefetch(number, action.kind, next / unit_);
      }
    }
    pause(number);
  }

  void issue(std::uint32_t number, std::uint32_t slot, const std::shared_ptr<Flight>& flight,
             memory::Address address, std::uint32_t bytes) {
    flight->done = never;
    nodes_[number].flights[slot] = flight;
    interconnect_of(number).read({number % machine_.nodes * ports_ + slot, address, bytes});
  }

  void read_done(std::uint32_t number, std::uint32_t slot, const memory::Service& service) {
    Node& node = nodes_[number];
    const auto flight = node.flights[slot];
    flight->service = service;
    flight->done = service.done;
    end_ = std::max(end_, service.done);
    for (std::uint32_t c = 0; c < machine_.contexts; ++c) {
      if (node.contexts[c].flight == flight && node.contexts[c].ready == never) {
        set_ready(number, c, service.done);
      }
    }
  }

  // The context at work has asked for something or is finished.
  void pause(std::uint32_t number) {
    Node& node = nodes_[number];
    if (node.contexts[*node.last].ready <= engine_.now()) {
      take_up(number, *node.last);
    } else if (const auto next = next_of(node)) {
      take_up(number, *next);
    } else {
      node.waiting = true;
      node.since = engine_.now();
    }
  }

  std::optional<std::uint32_t> next_of(const Node& node) const {
    const std::uint32_t first = node.last ? *node.last + 1 : 0;
    for (std::uint32_t i = 0; i < machine_.contexts; ++i) {
      const std::uint32_t c = (first + i) % machine_.contexts;
      if (node.contexts[c].ready <= engine_.now()) {
        return c;
      }
    }
    return std::nullopt;
  }

  void wake(std::uint32_t number) {
    Node& node = nodes_[number];
    const auto next = next_of(node);
    if (!next) {
      return;
    }
    const auto flight = node.contexts[*next].flight;
    if (!flight) {
      spend(node, processors::cost::Activity::dispatch_wait, engine_.now() - node.since);
    } else if (flight->second_level) {
      spend(node, processors::cost::Activity::cache_access, engine_.now() - node.since);
    } else {
      // Where each phase would be in this order; the node waited from `since` on.
      sim::Ticks at = flight->done - flight->service.wait_interconnect - flight->service.transfer -
                      flight->service.wait_bank - flight->service.bank;
      const auto phase = [&](processors::cost::Activity activity, sim::Ticks length) {
        const sim::Ticks from = std::max(at, node.since);
        at += length;
        spend(node, activity, std::max<sim::Ticks>(0, at - from));
      };
      phase(processors::cost::Activity::interconnect_wait, flight->service.wait_interconnect);
      phase(processors::cost::Activity::transfer, flight->service.transfer);
      phase(processors::cost::Activity::bank_wait, flight->service.wait_bank);
      phase(processors::cost::Activity::bank_access, flight->service.bank);
      if (counted_ != nullptr) {
        counted_->wait(node.contexts[*next].waits_for, engine_.now() - node.since);
      }
    }
    node.waiting = false;
    take_up(number, *next);
  }

  void take_up(std::uint32_t number, std::uint32_t which) {
    Node& node = nodes_[number];
    node.time = engine_.now();
    if (node.last && *node.last != which) {
      const sim::Ticks time = machine_.clock.cycles(machine_.switch_cycles);
      spend(node, processors::cost::Activity::switching, time);
      node.time += time;
      ++node.counts.switches;
    }
    node.last = which;
    node.contexts[which].ready = never;
    node.contexts[which].flight = nullptr;
    engine_.post(sim::Event::make(node.time, 0, number));
  }

  void write(std::uint32_t number) {
    Node& node = nodes_[number];
    if (node.buffer.front() == never) {
      node.stalled = true;
      return;
    }
    if (node.buffer.front() > node.time) {
      spend(node, processors::cost::Activity::queue_full_wait, node.buffer.front() - node.time);
      node.time = node.buffer.front();
      engine_.post(sim::Event::make(node.time, 4, number));
      return;
    }
    Context& context = node.contexts[*node.last];
    ++node.statistics.writes;
    node.buffer.pop_front();
    node.buffer.push_back(never);
    interconnect_of(number).write({number % machine_.nodes * ports_, context.actions[context.next].address,
                                   machine_.layout.pixel_bytes});
    go_on(number, processors::cost::Activity::shading, 0);
  }

  // ---- the cache

  int cache_of(memory::RecordKind kind) const {
    constexpr std::array<int, 7> part = {0, 0, 1, 2, 3, 3, 3};
    return machine_.cache.organisation == processors::machine::CacheOrganisation::split
               ? part[static_cast<std::size_t>(kind)]
               : 0;
  }
  Key key_of(memory::RecordKind kind, std::uint64_t line) const { return {cache_of(kind), line}; }
  std::list<std::uint64_t>& set_of(Node& node, const Key& key) {
    return node.sets[{key.first, key.second % shape_of(key.first).sets}];
  }
  memory::CacheShape shape_of(int cache) const {
    memory::CacheConfig config = machine_.cache.cache;
    if (machine_.cache.organisation == processors::machine::CacheOrganisation::split) {
      config.size = machine_.cache.split_sizes[static_cast<std::size_t>(cache)];
    }
    return memory::shape_of(config);
  }
  bool in_cache(Node& node, const Key& key) {
    const auto& set = set_of(node, key);
    return std::find(set.begin(), set.end(), key.second) != set.end();
  }
  // A reference: brings the line in when it is not there.
  void look_up(Node& node, const Key& key) {
    auto& set = set_of(node, key);
    if (node.unasked.erase(key) != 0) {
      ++node.counts.useful;
    }
    const auto at = std::find(set.begin(), set.end(), key.second);
    if (at == set.end()) {
      bring_in(node, key);
    } else if (machine_.cache.cache.replacement == memory::Replacement::lru) {
      set.splice(set.begin(), set, at);
    }
  }
  // The transaction for which a reference to the line has to wait.
  std::shared_ptr<Flight> under_way(Node& node, const Key& key) {
    const auto is_coming = [&](const auto& flight) { return flight && flight->done > engine_.now(); };
    const auto own = node.brought.find(key);
    const bool own_is_coming = own != node.brought.end() && is_coming(own->second);
    if (in_cache(node, key)) {
      return own_is_coming ? own->second : nullptr;
    }
    if (has_second_level()) {
      const auto at = std::find_if(node.flights.begin(), node.flights.end(), [&](const auto& flight) {
        return is_coming(flight) && flight->line == key.second;
      });
      return at == node.flights.end() ? nullptr : *at;
    }
    return nullptr;
  }
  [[nodiscard]] bool has_second_level() const {
    return machine_.l2.sharing == processors::machine::SecondLevel::private_caches;
  }
  // Looks the second level up; brings the line in when it is not there.
  bool second_level_has(Node& node, std::uint64_t line) {
    if (!has_second_level()) {
      return false;
    }
    const memory::CacheShape shape = memory::shape_of(processors::machine::second_level_cache(machine_));
    auto& set = node.second_sets[line % shape.sets];
    const auto at = std::find(set.begin(), set.end(), line);
    const bool hit = at != set.end();
    ++(hit ? node.second_level.hits : node.second_level.misses);
    if (!hit) {
      if (set.size() == shape.ways) {
        set.pop_back();
      }
      set.push_front(line);
    } else if (machine_.l2.cache.replacement == memory::Replacement::lru) {
      set.splice(set.begin(), set, at);
    }
    return hit;
  }
  void bring_in(Node& node, const Key& key) {
    auto& set = set_of(node, key);
    if (set.size() == shape_of(key.first).ways) {
      if (node.unasked.erase({key.first, set.back()}) != 0) {
        ++node.counts.useless;
      }
      set.pop_back();
    }
    set.push_front(key.second);
  }

  void prefetch(std::uint32_t number, memory::RecordKind kind, std::uint64_t line) {
    Node& node = nodes_[number];
    const Key key = key_of(kind, line);
    if (in_cache(node, key) || under_way(node, key)) {
      return;
    }
    for (std::uint32_t slot = machine_.contexts; slot < ports_; ++slot) {
      if (!node.flights[slot] || node.flights[slot]->done <= engine_.now()) {
        ++node.counts.issued;
        bring_in(node, key);
        node.unasked.insert(key);
        auto flight = std::make_shared<Flight>();
        flight->line = line;
        flight->prefetch = true;
        node.brought[key] = flight;
        if (counted_ != nullptr) {
          counted_->bring_in(number, static_cast<std::size_t>(key.first), line);
        }
        if (second_level_has(node, line)) {
          const sim::Ticks hit = machine_.l2.clock.value_or(machine_.clock).cycles(machine_.l2.hit_cycles);
          node.flights[slot] = flight;
          flight->second_level = true;
          read_done(number, slot, {engine_.now() + hit, 0, 0, 0, 0});
        } else {
          issue(number, slot, flight, line * unit_, unit_);
        }
        return;
      }
    }
    ++node.counts.dropped;
  }
  void prefetch_children(std::uint32_t number, std::uint32_t branch) {
    if (!machine_.prefetch.children) {
      return;
    }
    const accel::TopologyNode& node = log_.topology.nodes[branch];
    std::set<std::uint64_t> lines;
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      const bool there = NaiveProgram::has_record(log_, child);
      for (std::uint32_t byte = 0; there && byte < program_.node_bytes(child); ++byte) {
        lines.insert((program_.node_address(child) + byte) / unit_);
      }
    }
    for (const std::uint64_t line : lines) {
      prefetch(number, memory::RecordKind::node, line);
    }
  }

  const processors::program::WorkLog& log_;
  processors::machine::MachineConfig machine_;
  NaiveProgram program_;
  processors::machine::PacketList packets_;
  processors::node::Host host_;
  bool cached_;
  std::uint32_t unit_;
  std::uint32_t ports_;
  NaiveCounts* counted_;
  sim::Engine engine_;
  std::vector<Node> nodes_;
  std::vector<Client> clients_;
  std::vector<std::unique_ptr<memory::Interconnect>> interconnects_;
  sim::Ticks end_ = 0;
};

}  // namespace marti::test
