// A processor node: in order, with private caches and a write buffer.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <systemc>
#include <tlm>
#include <vector>

#include <tlm_utils/simple_initiator_socket.h>

#include "processors/cost/accounting.h"
#include "processors/machine/machine_config.h"
#include "tests/validation/systemc/cache.h"
#include "tests/validation/systemc/host.h"
#include "tests/validation/systemc/instant.h"
#include "tests/validation/systemc/program.h"
#include "tests/validation/systemc/transport.h"

namespace marti::oracle {

class Node : public sc_core::sc_module, public TurnTaker, public PacketUser {
 public:
  /// All references must outlive it.
  Node(const sc_core::sc_module_name& name, Turns& turns, std::uint32_t number,
       const processors::machine::MachineConfig& config, const processors::program::WorkLog& log,
       const Database& database, const processors::cost::StepTicks& ticks);

  tlm_utils::simple_initiator_socket<Node> socket;
  sc_core::sc_port<HostInterface> host;

  /// All statistics except the idle time, which is known when all nodes are done.
  [[nodiscard]] const processors::cost::NodeStatistics& statistics() const { return statistics_; }
  [[nodiscard]] bool finished() const { return finished_; }
  /// When its last write was done; 0 if it made none.
  [[nodiscard]] Time last_write() const { return last_write_; }

 private:
  /// A posted write and whether it is done.
  struct Posted {
    tlm::tlm_generic_payload* payload = nullptr;
    bool done = false;
  };

  void start();
  void work();
  bool sleep(Time duration);
  bool refer();
  bool look_up(std::uint64_t line);
  bool miss(std::uint64_t address, std::uint64_t bytes);
  void send(tlm::tlm_generic_payload& payload);
  void write();
  void account(const Course& course);
  void spend(processors::cost::Activity activity, Time time) {
    statistics_.time[static_cast<std::size_t>(activity)] += time;
  }
  void take_turn(Turn turn, std::uint32_t node) override;
  void begin_packet(const std::optional<Rectangle>& packet) override;
  tlm::tlm_sync_enum answer(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                            sc_core::sc_time& delay);

  Turns& turns_;
  std::uint32_t number_;
  const processors::machine::MachineConfig& config_;
  Time hit_;
  processors::cost::NodeStatistics statistics_;
  std::vector<NaiveCache> caches_;
  Program program_;
  sc_core::sc_event awake_;

  std::vector<Operation> operations_;  // of the step at hand
  std::size_t next_ = 0;               // the first operation that has not begun
  Operation reading_;                  // the record being read; without bytes left: no record
  Extent missed_;                      // what is to be read from shared memory

  PayloadPool payloads_;
  std::deque<Posted> posted_;  // the write buffer, oldest first
  bool waits_for_room_ = false;
  Time since_ = 0;  // when it asked the host, or began to wait for room
  Time last_write_ = 0;
  bool finished_ = false;
};

}  // namespace marti::oracle
