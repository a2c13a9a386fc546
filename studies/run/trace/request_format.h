// The forms in which other programs read what nodes ask of the memory.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "memory/layout.h"
#include "processors/machine/machine_config.h"
#include "processors/walk/observer.h"

namespace marti::studies::run {

/// Appends a request to the text or bytes of a file.
using AppendRequest = std::function<void(const processors::walk::Request&, std::string& file)>;

struct RequestFormat {
  std::string_view name;  ///< after --format
  std::string_view file;  ///< its name; of a format with a file for each node, the extension
  bool file_per_node;
  /// What a file begins with.
  std::string (*head)();
  /// Both must outlive what is returned. Throws UserError for a machine of which there is no such trace.
  AppendRequest (*append)(const processors::machine::MachineConfig& machine, const memory::Layout& layout);
};

/// What a request has in forms without sizes: a burst of DRAM, else what one reference of a node reads.
[[nodiscard]] std::uint32_t burst_of(const processors::machine::MachineConfig& machine);
/// The cycle in which DRAMsim3's traces count: of the DRAM, else of the banks.
[[nodiscard]] sim::Ticks cycle_of(const processors::machine::MachineConfig& machine);

/// All of them, of the traces of requests; `din` is of references (trace.h).
[[nodiscard]] std::span<const RequestFormat> request_formats();

}  // namespace marti::studies::run
