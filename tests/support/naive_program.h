// The steps of a log flattened into single actions, record by record, from the layout and the step costs
// alone.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "memory/layout.h"
#include "processors/cost/step_time.h"
#include "processors/machine/machine_config.h"
#include "processors/machine/packets.h"
#include "processors/program/work_log.h"

namespace marti::test {

using namespace processors::cost;
using namespace processors::machine;
using namespace processors::program;

struct NaiveAction {
  enum class What { compute, refer, children, write } what = What::compute;
  Activity activity = Activity::traversal;
  sim::Ticks time = 0;
  memory::RecordKind kind = memory::RecordKind::node;
  memory::Address address = 0;
  std::uint32_t bytes = 0;
  std::uint32_t branch = 0;
  std::uint32_t ray = 0;    ///< operand of the `ray` step that it belongs to
  std::uint32_t level = 0;  ///< of the tree node that is visited; 0 for materials and texels
  bool splitting = false;   ///< to split a branch
};

/// Whether the action is for the objects that a leaf lists, not for its record.
inline bool is_of_objects(const NaiveAction& action) {
  return action.activity == Activity::intersection || action.kind == memory::RecordKind::list ||
         action.kind == memory::RecordKind::primitive;
}

/// Counts one step.
inline void count_step(const WorkLog& log, const std::uint32_t* word, StepCounts& steps) {
  const std::uint32_t operand = operand_of(*word);
  const Step step = step_of(*word);
  switch (step) {
    case Step::branch:
      ++steps.branches;
      break;
    case Step::leaf:
    case Step::partial_leaf:
    case Step::mailed_leaf: {
      const accel::TopologyNode& leaf = log.topology.nodes[operand];
      const std::uint32_t entries = step == Step::leaf ? leaf.count : word[1];
      ++steps.leaves;
      steps.lists += entries > 0 ? 1 : 0;
      steps.lookups += log.mailboxes ? entries : 0;
      for (std::uint32_t i = 0; i < entries; ++i) {
        if (step != Step::mailed_leaf || tested_in_mask(word + 2, i)) {
          (void)count_test(StepTicks(), log.kind_of(log.topology.entries[leaf.first + i]), steps);
        }
      }
      break;
    }
    case Step::ray:
      ++(steps.*ray_counters[ray_number_of(operand)]);
      break;
    case Step::shade:
      ++steps.shades;
      break;
    case Step::light:
      ++steps.lights;
      break;
    case Step::texel:
      ++steps.texels;
      break;
    case Step::transform:
      ++steps.transforms;
      break;
    case Step::cut:
      ++steps.cuts;
      break;
    case Step::pass:
      ++steps.passes;
      break;
    case Step::any_hit:
      ++steps.any_hits;
      break;
  }
}

class NaiveProgram {
 public:
  using Action = NaiveAction;

  NaiveProgram(const WorkLog& log, const MachineConfig& machine)
      : log_(log),
        machine_(machine),
        layout_(
            machine.layout,
            {count_records(log, false), count_records(log, true), log.topology.entries.size(), log.primitives,
             log.materials, log.texture_begin.back(), std::uint64_t{log.width} * log.height},
            log.quadrics.size()),
        ticks_(step_ticks(machine, log)),
        unit_(machine.cache.organisation != CacheOrganisation::none ? machine.cache.cache.line
                                                                    : machine.banks.interleave) {
    number_records();
  }

  [[nodiscard]] const memory::Layout& layout() const { return layout_; }
  [[nodiscard]] const StepTicks& ticks() const { return ticks_; }
  [[nodiscard]] std::uint32_t unit() const { return unit_; }
  memory::Address node_address(std::uint32_t node) const {
    return layout_.address(record_kind(log_, node), rank_[node]);
  }
  /// An instance's record is its transform.
  static memory::RecordKind record_kind(const WorkLog& log, std::uint32_t node) {
    return log.topology.nodes[node].instance ? memory::RecordKind::transform : memory::RecordKind::node;
  }
  [[nodiscard]] std::uint32_t node_bytes(std::uint32_t node) const {
    return layout_.record_bytes(record_kind(log_, node));
  }
  /// The leaves of a bounding volume hierarchy have no records.
  static bool has_record(const WorkLog& log, std::uint32_t node) {
    return !log.topology.nodes[node].leaf || !accel::walks_bvh(log.traversal);
  }
  /// The actions of one step of a ray, which is named by the operand of its `ray` step.
  std::vector<Action> actions_of(const std::uint32_t* word, std::uint32_t ray) const {
    std::vector<Action> actions;
    step(actions, word);
    for (Action& action : actions) {
      action.ray = ray;
      action.level = visits_node(step_of(*word)) ? log_.topology.nodes[operand_of(*word)].level : 0;
    }
    return actions;
  }
  /// The actions of a packet. `ray`, the ray that the context was at work on, becomes the packet's last.
  std::vector<Action> actions_of(const Packet& packet, std::uint32_t& ray) const {
    std::vector<Action> actions;
    for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
      for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
        const auto words = log_.pixel(x, y);
        for (std::size_t i = 0; i < words.size(); i += step_words(&words[i])) {
          ray = step_of(words[i]) == Step::ray ? operand_of(words[i]) : ray;
          const std::vector<Action> of_step = actions_of(&words[i], ray);
          actions.insert(actions.end(), of_step.begin(), of_step.end());
        }
        compute(actions, Activity::shading, ticks_.pixel);
        actions.push_back({Action::What::write});
        actions.back().address =
            layout_.address(memory::RecordKind::pixel, std::uint64_t{y} * log_.width + x);
      }
    }
    return actions;
  }

 private:
  static std::uint64_t count_records(const WorkLog& log, bool instances) {
    std::uint64_t count = 0;
    for (std::uint32_t node = 0; node < log.topology.nodes.size(); ++node) {
      count += has_record(log, node) && log.topology.nodes[node].instance == instances ? 1 : 0;
    }
    return count;
  }
  // Writes the nodes in their order first, then numbers those with records, instances by themselves. What
  // several instances have below them comes where the first of them has it.
  void number_records() {
    std::vector<std::uint32_t> order = {0};
    switch (machine_.layout.node_order) {
      case memory::NodeOrder::breadth_first:
        for (std::uint32_t node = 1; node < log_.topology.nodes.size(); ++node) {
          order.push_back(node);
        }
        break;
      case memory::NodeOrder::depth_first:
        order_below(0, order);
        break;
      case memory::NodeOrder::treelets:
        order_by_treelets(order);
        break;
    }
    rank_.resize(log_.topology.nodes.size());
    std::vector<bool> numbered(rank_.size());
    std::array<std::uint32_t, 2> next{};
    for (const std::uint32_t node : order) {
      if (!numbered[node] && has_record(log_, node)) {
        rank_[node] = next[log_.topology.nodes[node].instance ? 1 : 0]++;
      }
      numbered[node] = true;
    }
  }
  void order_below(std::uint32_t number, std::vector<std::uint32_t>& order) {
    const accel::TopologyNode& node = log_.topology.nodes[number];
    for (std::uint32_t child = 0; !node.leaf && child < node.count; ++child) {
      order.push_back(node.first + child);
    }
    for (std::uint32_t child = 0; !node.leaf && child < node.count; ++child) {
      order_below(node.first + child, order);
    }
  }
  void order_by_treelets(std::vector<std::uint32_t>& order) {
    std::uint32_t apart = machine_.layout.node_bytes;
    while (apart % machine_.layout.record_alignment != 0) {
      ++apart;
    }
    const std::size_t room = std::max<std::size_t>(1, machine_.layout.treelet_bytes / apart);
    std::vector<std::uint32_t> tops = {0};
    std::vector<bool> taken(log_.topology.nodes.size());  // several instances have one mesh below them
    std::size_t filled = 1;
    while (!tops.empty()) {
      std::vector<std::uint32_t> at_hand = {tops.front()};
      tops.erase(tops.begin());
      std::vector<std::uint32_t> left;
      while (!at_hand.empty()) {
        const std::uint32_t number = at_hand.front();
        at_hand.erase(at_hand.begin());
        const accel::TopologyNode& node = log_.topology.nodes[number];
        std::size_t records = 0;
        for (std::uint32_t child = 0; !node.leaf && child < node.count; ++child) {
          const std::uint32_t below = node.first + child;
          records += has_record(log_, below) && !log_.topology.nodes[below].instance && !taken[below] ? 1 : 0;
        }
        if (!node.leaf && (!left.empty() || (filled > 0 && filled + records > room))) {
          left.push_back(number);
          continue;
        }
        filled += records;
        for (std::uint32_t child = 0; !node.leaf && child < node.count; ++child) {
          if (!taken[node.first + child]) {
            order.push_back(node.first + child);
            at_hand.push_back(node.first + child);
            taken[node.first + child] = true;
          }
        }
      }
      tops.insert(tops.begin(), left.begin(), left.end());
      filled = 0;
    }
  }

  static void compute(std::vector<Action>& to, Activity activity, sim::Ticks time) {
    to.push_back({Action::What::compute, activity, time});
  }
  void read(std::vector<Action>& to, memory::RecordKind kind, memory::Address at, std::uint64_t bytes) const {
    for (const memory::Address end = at + bytes; at < end;) {
      const memory::Address stop = std::min<memory::Address>(end, (at / unit_ + 1) * unit_);
      to.push_back(
          {Action::What::refer, Activity::cache_access, 0, kind, at, static_cast<std::uint32_t>(stop - at)});
      at = stop;
    }
  }
  void read_node(std::vector<Action>& to, std::uint32_t node) const {
    if (has_record(log_, node)) {
      read(to, record_kind(log_, node), node_address(node), node_bytes(node));
    }
  }
  void read_material(std::vector<Action>& to, std::uint32_t material) const {
    read(to, memory::RecordKind::material, layout_.address(memory::RecordKind::material, material),
         machine_.layout.material_bytes);
  }
  void leaf(std::vector<Action>& to, std::uint32_t number, std::uint32_t entries,
            const std::uint32_t* mask) const {
    const accel::TopologyNode& node = log_.topology.nodes[number];
    compute(to, Activity::traversal, ticks_.leaf);
    read_node(to, number);
    if (entries > 0) {
      read(to, memory::RecordKind::list, layout_.address(memory::RecordKind::list, node.first),
           std::uint64_t{entries} * machine_.layout.entry_bytes);
    }
    for (std::uint32_t i = 0; i < entries; ++i) {
      compute(to, Activity::intersection, log_.mailboxes ? ticks_.lookup : 0);
      if (mask != nullptr && !tested_in_mask(mask, i)) {
        continue;
      }
      const std::uint32_t primitive = log_.topology.entries[node.first + i];
      const std::array<sim::Ticks, 3> tests = {ticks_.test, ticks_.sphere_test, ticks_.cone_test};
      compute(to, Activity::intersection, tests[static_cast<std::size_t>(log_.kind_of(primitive))]);
      read(to, memory::RecordKind::primitive, layout_.address(memory::RecordKind::primitive, primitive),
           layout_.record_bytes(memory::RecordKind::primitive, primitive));
    }
  }
  void step(std::vector<Action>& to, const std::uint32_t* word) const {
    const std::uint32_t operand = operand_of(*word);
    switch (step_of(*word)) {
      case Step::branch:
        compute(to, Activity::traversal, ticks_.branch);
        read_node(to, operand);
        to.push_back({Action::What::children});
        to.back().branch = operand;
        break;
      case Step::leaf:
        leaf(to, operand, log_.topology.nodes[operand].count, nullptr);
        break;
      case Step::partial_leaf:
        leaf(to, operand, word[1], nullptr);
        break;
      case Step::mailed_leaf:
        leaf(to, operand, word[1], word + 2);
        break;
      case Step::ray:
        compute(to, Activity::traversal, ticks_.ray[ray_number_of(operand)]);
        break;
      case Step::shade:
        compute(to, Activity::shading, ticks_.shade);
        read_material(to, operand);
        break;
      case Step::any_hit:
        compute(to, Activity::shading, ticks_.any_hit);
        read_material(to, operand);
        break;
      case Step::pass:
        compute(to, Activity::traversal, ticks_.pass);
        read_material(to, operand);
        break;
      case Step::transform:
        compute(to, Activity::traversal, ticks_.transform);
        read_node(to, operand);
        to.push_back({Action::What::children});
        to.back().branch = operand;
        break;
      case Step::cut:
        compute(to, Activity::traversal, ticks_.cut);
        read_node(to, operand);
        break;
      case Step::light:
        compute(to, Activity::shading, ticks_.light);
        break;
      case Step::texel:
        compute(to, Activity::shading, ticks_.texel);
        read(to, memory::RecordKind::texel,
             layout_.address(memory::RecordKind::texel, log_.texture_begin[operand] + word[1]),
             machine_.layout.texel_bytes);
        break;
    }
  }

  const WorkLog& log_;
  MachineConfig machine_;
  memory::Layout layout_;
  StepTicks ticks_;
  std::uint32_t unit_;
  std::vector<std::uint32_t> rank_;
};

}  // namespace marti::test
