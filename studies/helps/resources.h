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
  /// The next better machine that one would build: a clock or a delay a tenth shorter, of numbers and sizes
  /// the next power of two, or the most that the key allows. Empty where its key allows nothing better.
  std::optional<Change> step;
  /// The end of the useful range: a delay costs no time, or there is as much as can be used. Empty where
  /// there is no such end, or the step leads there already.
  std::optional<Change> best;
  /// How many times as good the step makes the resource; of what has no measure, as the sizes of caches, a
  /// guess.
  double factor = 2.0;
  /// Whether every step of a ray still takes the same number of cycles of a node.
  bool same_work = true;
  /// Nothing in the frame has ever waited for this resource, so improving it cannot change the frame time.
  bool same_frame = false;
};

/// The least power of two above `number`, which must be at least 0.
[[nodiscard]] std::int64_t next_power(std::int64_t number);

/// Divided by 1.1, rounded down, and at least one less.
[[nodiscard]] std::int64_t tenth_less(std::int64_t number);

/// A clock: a tenth faster, or at periods of a few ticks the next shorter one.
[[nodiscard]] Resource faster_clock(const Changer& changer, Part part, std::string_view key);
/// A number of things or bytes: the next power of two; at best the least power of two from `useful` on,
/// beyond which nothing is gained, and without it eight times as many.
[[nodiscard]] Resource more(const Changer& changer, Part part, std::string_view key,
                            std::optional<std::int64_t> useful = std::nullopt);
/// A number of cycles or bytes that is to be small: divided by 1.1, and at least one less; at best `least`.
[[nodiscard]] Resource fewer(const Changer& changer, Part part, std::string_view key, std::int64_t least = 0);

/// Those of the machine's first- and second-level caches. `database_bytes`: of one copy of the database. At
/// its best a size is the next power of two from the database on, so that each line has a place of its own in
/// a cache for all records, and ways are 64 or as many below as can be built.
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
  bool instances = true;         ///< rays were brought into the coordinates of meshes
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
