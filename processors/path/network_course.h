// The chains of the messages of a network.
#pragma once

#include <cstdint>
#include <memory>

#include "memory/network.h"
#include "processors/path/path_pieces.h"

namespace marti::processors::path {

class NetworkCourse {
 public:
  virtual ~NetworkCourse() = default;

  /// The chain of a message that is sent when `sent` ends, up to its arrival; calls come in the order of
  /// sending. A message to its own port takes no time.
  virtual PathTip send(const PathTip& sent, std::uint32_t from, std::uint32_t to, std::uint32_t bytes,
                       const PathOwner& owner) = 0;
};

/// The course of memory::make_network's network. What its links do are pieces of `kind`.
[[nodiscard]] std::unique_ptr<NetworkCourse> make_network_course(const memory::NetworkConfig& config,
                                                                 std::uint32_t nodes, PathPieces& pieces,
                                                                 PathKind kind);
/// At most so many bytes of the host are taken by such a course, without pieces.
[[nodiscard]] std::uint64_t network_course_bytes(const memory::NetworkConfig& config, std::uint32_t nodes);

}  // namespace marti::processors::path
