// The chains of the messages of a network.
#pragma once

#include <cstdint>
#include <memory>

#include "memory/network.h"
#include "processors/path/path_pieces.h"

namespace marti::processors {

class NetworkCourse {
 public:
  virtual ~NetworkCourse() = default;

  /// The chain of a message that is sent when `sent` ends, up to its arrival; calls come in the order of
  /// sending. A message to its own port takes no time.
  virtual PathTip send(const PathTip& sent, std::uint32_t from, std::uint32_t to, std::uint32_t bytes,
                       const PathOwner& owner) = 0;
};

/// The course of memory::make_network's network.
[[nodiscard]] std::unique_ptr<NetworkCourse> make_network_course(const memory::NetworkConfig& config,
                                                                 std::uint32_t nodes, PathPieces& pieces);

}  // namespace marti::processors
