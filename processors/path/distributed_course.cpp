#include <vector>

#include "processors/node/memory_system.h"
#include "processors/path/fifo.h"
#include "processors/path/memory_course.h"
#include "processors/path/network_course.h"
#include "sim/error.h"
#include "sim/event.h"

namespace marti::processors::path {

namespace {

using sim::Ticks;

// Events and their sequence numbers are those of memory/distributed.cpp.
class DistributedCourse final : public MemoryCourse {
 public:
  DistributedCourse(const machine::MachineConfig& config, PathPieces& pieces)
      : pieces_(pieces),
        config_(node::distributed_config(config)),
        ports_per_node_(config.ports_of_node()),
        access_(config_.clock.cycles(config_.access_cycles)),
        beat_(config_.clock.cycles(config_.cycles_per_beat)),
        network_(make_network_course(config_.network, config.nodes, pieces, PathKind::transfer)),
        homes_(config.nodes),
        ports_(std::size_t{config.nodes} * ports_per_node_) {}

  void ask(const PathRequest& request) override {
    Port& port = ports_[request.transaction.port];
    Transfer transfer = {request, home_of(request.transaction.address)};
    const std::uint32_t node = node_of(request.transaction.port);
    const bool local = transfer.home == node;
    if (!local) {
      transfer.request.asking = network_->send(
          request.asking, node, transfer.home,
          config_.header_bytes + (request.write ? request.transaction.bytes : 0), request.owner);
    }
    if (request.write) {
      port.writes.push_back(std::move(transfer));
      if (local) {
        serve(port.writes.back());
      }
      return;
    }
    port.read = std::move(transfer);
    if (local) {
      serve(port.read);
    }
  }

  void proceed(std::uint32_t number, std::uint32_t sequence) override {
    Port& port = ports_[number];
    if (sequence != 0) {
      serve(port.writes[(sequence - 1 + write_numbers - port.first) % write_numbers]);
    } else if (!port.read.served) {
      serve(port.read);
    } else {
      const PathRequest& read = port.read.request;
      port.read.request.asking = network_->send(read.asking, port.read.home, node_of(number),
                                                config_.header_bytes + read.transaction.bytes, read.owner);
    }
  }

  PathTip read_done(std::uint32_t port) override { return ports_[port].read.request.asking; }

  PathTip write_done(std::uint32_t number) override {
    Port& port = ports_[number];
    sim::ensure(!port.writes.empty() && port.writes.front().served, "a write is done that is not served");
    port.first = (port.first + 1) % write_numbers;
    return port.writes.pop_front().request.asking;
  }

 private:
  static constexpr std::uint32_t write_numbers = (1U << sim::sequence_bits) - 1;

  struct Transfer {
    PathRequest request;  // asking: its chain so far
    std::uint32_t home = 0;
    bool served = false;
  };
  struct Port {
    Transfer read;
    Fifo<Transfer> writes;
    std::uint32_t first = 0;  // number of the oldest
  };

  [[nodiscard]] std::uint32_t home_of(memory::Address address) const {
    return static_cast<std::uint32_t>(address / config_.interleave % config_.nodes);
  }
  [[nodiscard]] std::uint32_t node_of(std::uint32_t port) const { return port / ports_per_node_; }

  // The transfer's home begins to serve it when its memory is free.
  void serve(Transfer& transfer) {
    PathRequest& request = transfer.request;
    PathTip& home = homes_[transfer.home];
    const Ticks beats = sim::multiply_ticks(
        beat_, (std::int64_t{request.transaction.bytes} + config_.width - 1) / config_.width);
    home = pieces_.append(later_of(request.asking, home), access_, request.owner, PathKind::bank_access);
    home = pieces_.append(home, beats, request.owner, PathKind::transfer);
    request.asking = home;
    transfer.served = true;
  }

  PathPieces& pieces_;
  memory::DistributedConfig config_;
  std::uint32_t ports_per_node_;
  Ticks access_;
  Ticks beat_;
  std::unique_ptr<NetworkCourse> network_;
  std::vector<PathTip> homes_;  // what each home's memory did last
  std::vector<Port> ports_;
};

}  // namespace

std::unique_ptr<MemoryCourse> make_distributed_course(const machine::MachineConfig& config,
                                                      PathPieces& pieces) {
  return std::make_unique<DistributedCourse>(config, pieces);
}

}  // namespace marti::processors::path
