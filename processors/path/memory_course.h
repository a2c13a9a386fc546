// What each transaction of a shared memory did when: its chain of transfers and accesses, and of those that
// kept the resources that it needed.
//
// A course keeps, for each resource of a memory system, the chain of the tenure that had it last, and grants
// tenures as the memory system itself does (docs/internals/model.md, Interconnects, Banks, Networks). It is
// told of each call that the memory system gets; WatchedMemory compares the end of every chain with the time
// that the memory system has given.
#pragma once

#include <memory>

#include "memory/interconnect.h"
#include "processors/machine/machine_config.h"
#include "processors/path/path_pieces.h"

namespace marti::processors::path {

/// A read or write as a node asks for it.
struct PathRequest {
  memory::Transaction transaction;
  PathTip asking;  ///< the chain of the node, up to the time of the request
  PathOwner owner;
  bool write = false;
};

class MemoryCourse {
 public:
  virtual ~MemoryCourse() = default;

  /// Called before the memory system is asked.
  virtual void ask(const PathRequest& request) = 0;
  /// Called before the memory system handles an event of its own.
  virtual void proceed(std::uint32_t /*port*/, std::uint32_t /*sequence*/) {}
  /// Called after the memory system has been asked, or has handled an event.
  virtual void settle() {}
  /// Called when the memory system reports that the port's read is done: the read's chain.
  virtual PathTip read_done(std::uint32_t port) = 0;
  /// Called when the memory system reports the port's oldest write: its chain.
  virtual PathTip write_done(std::uint32_t port) = 0;
};

/// The course of a cluster's memory system `memory`, which must outlive it, as the pieces must.
[[nodiscard]] std::unique_ptr<MemoryCourse> make_memory_course(const machine::MachineConfig& config,
                                                               const memory::Interconnect& memory,
                                                               PathPieces& pieces);
/// At most so many bytes of the host are taken by the courses of all clusters, without pieces and lines that
/// a shared cache brings in.
[[nodiscard]] std::uint64_t course_bytes(const machine::MachineConfig& config);
/// As make_memory_course() where the memory is spread over the nodes.
[[nodiscard]] std::unique_ptr<MemoryCourse> make_distributed_course(const machine::MachineConfig& config,
                                                                    PathPieces& pieces);

}  // namespace marti::processors::path
