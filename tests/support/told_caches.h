// Caches of nodes that build the tree, one reference at a time, which tell NaiveCounts of every one.
#pragma once

#include <memory>
#include <optional>

#include "processors/node/context_building_nodes.h"
#include "processors/node/dynamic_nodes.h"
#include "processors/node/node_factory.h"
#include "processors/replay/replay_parts.h"
#include "processors/walk/build_start.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/record_places.h"
#include "tests/support/naive_counts.h"

namespace marti::test {

class ToldCaches {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = true;
  static constexpr bool counted = true;

  /// From address `own` on, each node has memory of its own.
  ToldCaches(const processors::machine::MachineConfig& machine, std::optional<memory::Address> own,
             NaiveCounts& counts)
      : caches_(std::make_unique<processors::walk::AnyCaches>(machine)),
        line_(machine.cache.cache.line),
        own_(own),
        counts_(counts) {}

  static NaiveAction action_of(memory::RecordKind kind, processors::walk::Origin origin) {
    NaiveAction action;
    action.kind = kind;
    action.ray = origin.ray;
    action.level = origin.level;
    action.splitting = origin.splitting;
    return action;
  }

  class View {
   public:
    View(ToldCaches& all, std::uint32_t node) : all_(all), node_(node), tags_(all.caches_->view(node)) {}
    bool access(memory::RecordKind kind, std::uint32_t line, const processors::walk::Use& use = {}) const {
      const bool hit = tags_.access(kind, line);
      all_.counts_.refer(node_, cache_of(kind), action_of(kind, use.origin), line, hit,
                         all_.own_ && memory::Address{line} * all_.line_ >= *all_.own_);
      return hit;
    }
    bool touch(memory::RecordKind kind, std::uint32_t line, const processors::walk::Use& use) const {
      return tags_.holds(kind, line) && access(kind, line, use);
    }
    [[nodiscard]] std::int64_t remove(std::uint32_t line) const {
      return tags_.remove_each(
          line, [&](std::size_t cache, bool held) { all_.counts_.written(node_, cache, line, held); });
    }
    void bring_in(memory::RecordKind kind, std::uint32_t line) const {
      (void)tags_.access(kind, line);
      all_.counts_.bring_in(node_, cache_of(kind), line);
    }
    [[nodiscard]] bool holds(memory::RecordKind kind, std::uint32_t line) const {
      return tags_.holds(kind, line);
    }
    [[nodiscard]] std::size_t cache_of(memory::RecordKind kind) const { return tags_.cache_of(kind); }

   private:
    ToldCaches& all_;
    std::uint32_t node_;
    processors::walk::AnyCaches::View tags_;
  };
  [[nodiscard]] View view(std::uint32_t node) { return {*this, node}; }

  struct Counting {
    NaiveCounts& counts;
    void second_level_hit(memory::RecordKind kind, processors::walk::Origin origin) const {
      counts.second_level_hit(action_of(kind, origin));
    }
    void wait(memory::RecordKind kind, processors::walk::Origin origin,
              const memory::Service& service) const {
      counts.wait(action_of(kind, origin),
                  service.wait_interconnect + service.transfer + service.wait_bank + service.bank);
    }
    static processors::walk::CacheCountResult result() { return {}; }
  };
  [[nodiscard]] Counting counting() const { return {counts_}; }

 private:
  std::unique_ptr<processors::walk::AnyCaches> caches_;
  memory::Address line_;
  std::optional<memory::Address> own_;
  NaiveCounts& counts_;
};

/// Times a machine with caches whose nodes build the tree, with an event for every reference, and tells
/// `counts`.
inline void tell_of_building(const processors::program::WorkLog& log,
                             const processors::machine::MachineConfig& machine, NaiveCounts& counts) {
  using namespace processors::machine;
  using namespace processors::node;
  using namespace processors::replay;
  using namespace processors::walk;
  std::optional<TreePlan> plan(std::in_place, log.topology, branch_starts(log.topology, machine.build),
                               machine);
  const memory::Layout layout = layout_of(log, machine, plan);
  const PacketList packets(log.width, log.height, machine.packets);
  const std::vector<std::uint32_t> rank = node_ranks(log, machine);
  sim::Engine engine;
  engine.reserve(std::size_t{machine.all_nodes()} * machine.contexts + 1);
  Host host(machine.host, packets.size(), machine.all_nodes());
  const ReplayInput input{log, machine, layout, packets, rank, true, &*plan};
  const bool own = machine.build.sharing == Sharing::private_trees;
  ToldCaches caches(machine, own ? std::optional<memory::Address>(plan->lower_base()) : std::nullopt, counts);
  std::unique_ptr<NodeArray> nodes;
  if (has_context_nodes(input)) {
    nodes = std::make_unique<ContextBuildingNodes<ToldCaches>>(input, engine, host, std::move(caches));
  } else {
    nodes = std::make_unique<DynamicNodes<ToldCaches>>(input, engine, host, std::move(caches));
  }
  const Interconnects interconnects = connect_memory(
      machine, engine, static_cast<std::uint8_t>(EventClass::memory), *nodes, nullptr, nullptr);
  for (const EventClass c : {EventClass::step, EventClass::dispatch, EventClass::reply, EventClass::read,
                             EventClass::write, EventClass::memory}) {
    engine.attach(static_cast<std::uint8_t>(c), *nodes);
  }
  nodes->start(0);
  nodes->run_all(engine);
}

}  // namespace marti::test
