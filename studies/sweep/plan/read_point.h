// One point of a sweep as a frame and a machine.
#pragma once

#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::sweep {

/// A configuration with a point's settings, read.
struct ReadPoint {
  sim::Config config;  ///< knows which keys were read
  keys::FrameConfig frame;
  std::string
      frame_digest;  ///< 32 hexadecimal digits of the frame's keys and values, host_machine.* left out
  std::vector<bool> frame_keys;  ///< for each key of the schema: has the frame read it?
  processors::machine::MachineConfig machine;
  sim::Ticks interval = 0;                    ///< of record.interval; 0: none
  std::string machine_digest;                 ///< digest of the keys that only the machine has read
  std::string timing_digest;                  ///< digest of what of these decides times and counts
  std::vector<sim::EffectiveValue> settings;  ///< these keys and values, in the order of the schema
};

/// Reads and checks frame and machine. Throws UserError naming file, line and key; keys that this machine
/// does not use are allowed.
[[nodiscard]] ReadPoint read_point(sim::Config config);

/// The keys and values of the frame's digest, in the order of the schema.
[[nodiscard]] std::vector<sim::EffectiveValue> frame_settings(const ReadPoint& point);

/// The configuration of processors::one_node_of(point.machine): what the point does not use has its default.
[[nodiscard]] sim::Config one_node_config(const ReadPoint& point);

/// Does one_node_config() give this key a value of its own, whatever the point gives it?
[[nodiscard]] bool is_set_for_one_node(std::string_view key);

}  // namespace marti::studies::sweep
