#include "processors/path/memory_course.h"

#include <optional>
#include <utility>
#include <vector>

#include "memory/arbitrated_bus.h"
#include "memory/link.h"
#include "processors/path/bank_courses.h"
#include "processors/path/fifo.h"
#include "processors/path/network_course.h"
#include "processors/walk/second_level.h"
#include "sim/error.h"

namespace marti::processors::path {

namespace {

using memory::InterconnectConfig;
using sim::Ticks;

// Every transaction takes the same time, known when it is asked for.
class IdealCourse final : public MemoryCourse {
 public:
  IdealCourse(const InterconnectConfig& config, PathPieces& pieces)
      : pieces_(pieces), latency_(memory::ideal_read(config)) {}
  void ask(const PathRequest& request) override {
    done_ = pieces_.append(request.asking, latency_, request.owner, PathKind::transfer);
  }
  PathTip read_done(std::uint32_t /*port*/) override { return done_; }
  PathTip write_done(std::uint32_t /*port*/) override { return done_; }

 private:
  PathPieces& pieces_;
  Ticks latency_;
  PathTip done_;
};

// A transaction's whole course is known when it is asked for.
class CrossbarCourse final : public MemoryCourse {
 public:
  CrossbarCourse(const machine::MachineConfig& config, const memory::Interconnect& memory, PathPieces& pieces)
      : pieces_(pieces),
        beats_(config.interconnect),
        latency_(config.interconnect.clock.cycles(config.interconnect.latency_cycles)),
        banks_(walk::banks_of(config), memory, pieces),
        links_(walk::banks_of(config).banks()) {}
  void ask(const PathRequest& request) override { request_ = request; }
  PathTip read_done(std::uint32_t /*port*/) override {
    const auto& [transaction, asking, owner, write] = request_;
    PathTip& link = links_[banks_.bank_of(transaction.address)];
    const PathTip ready = banks_.read(transaction.address, transaction.bytes, cross(asking), owner);
    link = pieces_.append(later_of(ready, link), beats_(transaction.bytes), owner, PathKind::transfer);
    return cross(link);
  }
  PathTip write_done(std::uint32_t /*port*/) override {
    const auto& [transaction, asking, owner, write] = request_;
    return pieces_.append(banks_.write(transaction.address, transaction.bytes, cross(asking), owner),
                          beats_(transaction.bytes), owner, PathKind::transfer);
  }

 private:
  PathTip cross(const PathTip& from) {
    return pieces_.append(from, latency_, request_.owner, PathKind::transfer);
  }

  PathPieces& pieces_;
  memory::BeatTime beats_;
  Ticks latency_;
  BankCourses banks_;
  std::vector<PathTip> links_;  // what each bank's link sent last
  PathRequest request_;
};

// Tenures follow each other in the order in which the bus grants them. Where it serves the first to ask
// first, a tenure is granted when it is asked for. Else it is granted in an event of the bus, and what was
// granted follows from what the bus reports in it: a read or write that is done, or nothing, which was the
// address of a read.
class BusCourse final : public MemoryCourse {
 public:
  BusCourse(const machine::MachineConfig& config, const memory::Interconnect& memory, PathPieces& pieces)
      : pieces_(pieces),
        beats_(config.interconnect),
        address_(config.interconnect.clock.cycles(config.interconnect.address_cycles)),
        split_(config.interconnect.mode == memory::BusMode::split),
        arbitrated_(dynamic_cast<const memory::ArbitratedBus*>(&memory)),
        banks_(walk::banks_of(config), memory, pieces),
        ports_(std::size_t{config.nodes} * config.ports_of_node()) {}

  void ask(const PathRequest& request) override {
    const std::uint32_t port = request.transaction.port;
    ports_[port].requests.push_back(request);
    if (arbitrated_ == nullptr) {
      granting_ = port;
    }
  }
  void proceed(std::uint32_t /*port*/, std::uint32_t /*sequence*/) override { granting_ = of_event; }
  void settle() override {
    if (granting_ != nobody) {
      send_address(granting_ == of_event ? arbitrated_->last_granted() : granting_);
    }
  }

  PathTip read_done(std::uint32_t port) override {
    if (granting_ != nobody && (arbitrated_ == nullptr || !ports_[port].under_way)) {
      send_address(port);
    }
    granting_ = nobody;
    std::optional<PathRequest>& under_way = ports_[port].under_way;
    sim::ensure(under_way.has_value(), "a bus has sent data that nobody has asked for");
    const PathTip before = split_ ? later_of(under_way->asking, bus_) : under_way->asking;
    bus_ = pieces_.append(before, beats_(under_way->transaction.bytes), under_way->owner, PathKind::transfer);
    under_way.reset();
    return bus_;
  }
  PathTip write_done(std::uint32_t port) override {
    granting_ = nobody;
    const auto [transaction, asking, owner, write] = take_request(port, true);
    bus_ = pieces_.append(later_of(asking, bus_), sim::add_ticks(address_, beats_(transaction.bytes)), owner,
                          PathKind::transfer);
    return banks_.write(transaction.address, transaction.bytes, bus_, owner);
  }

 private:
  static constexpr std::uint32_t nobody = 0xffffffffU;
  static constexpr std::uint32_t of_event = nobody - 1;

  struct Port {
    Fifo<PathRequest> requests;
    std::optional<PathRequest> under_way;  // a read whose address is sent; asking: up to its data
  };

  PathRequest take_request(std::uint32_t port, bool write) {
    Port& from = ports_[port];
    sim::ensure(!from.requests.empty() && from.requests.front().write == write,
                "a bus has granted what was not asked for");
    return from.requests.pop_front();
  }

  void send_address(std::uint32_t port) {
    granting_ = nobody;
    PathRequest request = take_request(port, false);
    bus_ = pieces_.append(later_of(request.asking, bus_), address_, request.owner, PathKind::transfer);
    request.asking = banks_.read(request.transaction.address, request.transaction.bytes, bus_, request.owner);
    ports_[port].under_way = std::move(request);
  }

  PathPieces& pieces_;
  memory::BeatTime beats_;
  Ticks address_;
  bool split_;
  const memory::ArbitratedBus* arbitrated_;  // null: first come, first served
  BankCourses banks_;
  PathTip bus_;  // what the bus carried last
  std::vector<Port> ports_;
  std::uint32_t granting_ = nobody;  // whose request the bus is granted to in the present call
};

}  // namespace

std::unique_ptr<MemoryCourse> make_memory_course(const machine::MachineConfig& config,
                                                 const memory::Interconnect& memory, PathPieces& pieces) {
  if (config.placement == machine::Placement::distributed) {
    return make_distributed_course(config, pieces);
  }
  switch (config.interconnect.kind) {
    case memory::InterconnectKind::ideal:
      return std::make_unique<IdealCourse>(config.interconnect, pieces);
    case memory::InterconnectKind::crossbar:
      return std::make_unique<CrossbarCourse>(config, memory, pieces);
    case memory::InterconnectKind::bus:
      break;
  }
  return std::make_unique<BusCourse>(config, memory, pieces);
}

std::uint64_t course_bytes(const machine::MachineConfig& config) {
  constexpr std::uint64_t bytes_a_request = sizeof(PathRequest) + 16;  // with its home and how far it is
  // An entry of a Fifo may take the place of four: half of them may be taken out, and its vector half full.
  constexpr std::uint64_t bytes_a_write = 4 * bytes_a_request;
  constexpr std::uint64_t bytes_a_port = 2 * bytes_a_request + bytes_a_write;
  const std::uint64_t bytes_a_cluster =
      config.placement == machine::Placement::distributed
          ? config.nodes * sizeof(PathTip) + network_course_bytes(config.network, config.nodes)
          : 2 * std::uint64_t{walk::banks_of(config).banks()} * sizeof(PathTip);
  return config.all_nodes() * (config.ports_of_node() * bytes_a_port + config.write_buffer * bytes_a_write) +
         config.clusters * bytes_a_cluster;
}

}  // namespace marti::processors::path
