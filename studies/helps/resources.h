// The resources of a machine that can be made better, and what better values of their keys are.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "processors/replay/replay.h"
#include "studies/helps/change.h"

namespace marti::studies::helps {

/// The part of a machine that a resource belongs to, by which a verdict says how busy it is.
enum class Part : std::uint8_t {
  nodes,
  caches,
  second_level,
  local_memory,
  interconnect,
  banks,
  network,
  messages,
  queues,
  host,
  building,
  regions
};

struct Resource {
  std::string name;  ///< the key that is changed, as results for programs name the resource
  Part part = Part::nodes;
  /// The resource a tenth better, or, where its key does not allow that value, better by the next larger
  /// amount that it allows. Empty where its key allows nothing better.
  std::optional<Change> step;
  /// As good as it can be: it costs no time, or there is as much of it as can be used. Empty where that is
  /// not defined.
  std::optional<Change> best;
  /// Whether every step of a ray still takes the same number of cycles of a node.
  bool same_work = true;
  /// Nothing in the frame has ever waited for this resource, so improving it cannot change the frame time.
  bool same_frame = false;
};

/// A tenth more, rounded up.
[[nodiscard]] std::int64_t tenth_more(std::int64_t count);

/// A clock: a tenth faster, or at periods of a few ticks the next shorter one; at best 1 THz, a cycle of one
/// tick.
[[nodiscard]] Resource faster_clock(const Changer& changer, Part part, std::string_view key);
/// A width in bytes: the next power of two; at best the most that the key may have.
[[nodiscard]] Resource wider(const Changer& changer, Part part, std::string_view key);
/// A number of things: a tenth more; at best `best`, or the most that the key may have.
[[nodiscard]] Resource more(const Changer& changer, Part part, std::string_view key);
[[nodiscard]] Resource more(const Changer& changer, Part part, std::string_view key, std::int64_t best);
/// A number of cycles or bytes that is to be small: divided by 1.1, by at least one
/// less; at best `least`.
[[nodiscard]] Resource fewer(const Changer& changer, Part part, std::string_view key, std::int64_t least = 0);

/// Those of the machine's first- and second-level caches. `database_bytes`: of one copy of the database. A
/// size grows by a tenth of the sets (or doubles where that cannot be built); at its best it is the next
/// power of two from the database on, so that each line has a place of its own in a cache for all records.
/// Ways become the next number that divides the lines; at their best all lines are one set.
void add_caches(const Changer& changer, const processors::machine::MachineConfig& machine,
                std::uint64_t database_bytes, std::vector<Resource>& resources);

/// Those of a memory of DRAM.
void add_dram(const Changer& changer, const memory::DramConfig& dram, std::vector<Resource>& resources);

/// The network, for rays that move or a distributed database; messages, queues and the rays in flight; the
/// nodes of each stage of a pipeline, which are added to the machine; the level at which space is cut.
void add_flow(const Changer& changer, const processors::machine::MachineConfig& machine,
              std::vector<Resource>& resources);

/// What the list depends on beside the machine.
struct FrameFacts {
  std::uint64_t packets = 0;
  std::uint64_t pixels = 0;
  std::uint64_t database_bytes = 0;
  bool writes_waited = true;     ///< a node has waited for room in its write buffer
  bool waited_for_banks = true;  ///< an access has waited for its bank
};

[[nodiscard]] FrameFacts facts_of(const processors::replay::MachineResult& result);

/// The resources that this machine has and that can be made better, in a fixed order. `changer` is of the
/// configuration of `machine`, `facts` of the frame it was timed on.
[[nodiscard]] std::vector<Resource> resources_of(const Changer& changer,
                                                 const processors::machine::MachineConfig& machine,
                                                 const FrameFacts& facts);

}  // namespace marti::studies::helps
