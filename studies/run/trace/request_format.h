// The forms in which other programs read what nodes ask of the memory, or refer to before their caches.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "memory/record_kind.h"
#include "processors/machine/machine_config.h"
#include "processors/walk/observer.h"

namespace marti::studies::run {

/// A line of a trace: what a node asks of the memory, or a reference of its own, or a write of either.
struct TraceEntry : processors::walk::Request {
  std::optional<memory::RecordKind> kind{};  ///< nothing: a line of a traversal stack
  std::optional<bool> hit{};  ///< of a reference that reads: whether a first-level cache has it
};

/// Appends an entry to the text or bytes of a file.
using AppendEntry = std::function<void(const TraceEntry&, std::string& file)>;

struct RequestFormat {
  std::string_view name;    ///< after --format
  std::string_view ending;  ///< of its files
  /// Whether each node has a file of its requests; else one file has all. References have a file of each node
  /// in all formats, because nodes run ahead of each other.
  bool file_per_node;
  bool only_references;
  /// What a file begins with.
  std::string (*head)(bool references);
  /// The machine must outlive what is returned. Throws UserError if there is no such trace of it.
  AppendEntry (*append)(const processors::machine::MachineConfig& machine);
};

/// What a request has in forms without sizes: a burst of DRAM, else what one reference of a node reads.
[[nodiscard]] std::uint32_t burst_of(const processors::machine::MachineConfig& machine);
/// The cycle in which DRAMsim3's traces count: of the DRAM, else of the banks.
[[nodiscard]] sim::Ticks cycle_of(const processors::machine::MachineConfig& machine);

[[nodiscard]] std::span<const RequestFormat> request_formats();

}  // namespace marti::studies::run
