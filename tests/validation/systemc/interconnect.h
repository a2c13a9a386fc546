// What all interconnects have: a target socket for each node of the cluster, an initiator socket for each
// bank.
#pragma once

#include <cstdint>
#include <memory>
#include <systemc>
#include <tlm>

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include "memory/bank.h"
#include "memory/interconnect.h"
#include "tests/validation/systemc/bank.h"
#include "tests/validation/systemc/transport.h"

namespace marti::oracle {

class Interconnect : public sc_core::sc_module {
 public:
  using NodeSocket = tlm_utils::simple_target_socket_tagged<Interconnect>;
  using BankSocket = tlm_utils::simple_initiator_socket_tagged<Interconnect>;

  /// One socket a node.
  sc_core::sc_vector<NodeSocket> sockets;

  [[nodiscard]] const memory::InterconnectStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const Waits& waits() const { return waits_; }
  [[nodiscard]] const sc_core::sc_vector<Bank>& banks() const { return banks_; }

 protected:
  /// `banks` of them stand behind it.
  Interconnect(const sc_core::sc_module_name& name, Turns& turns, const memory::InterconnectConfig& config,
               const memory::BankConfig& bank_config, std::uint32_t nodes, std::uint32_t banks);

  /// A request has come, at course_of(payload).asked.
  virtual void accept(tlm::tlm_generic_payload& payload) = 0;
  /// A bank has done its work, at course_of(payload).ready.
  virtual void bank_ready(tlm::tlm_generic_payload& payload) = 0;

  void send_to_bank(tlm::tlm_generic_payload& payload);
  /// The whole transaction is done now.
  void respond(tlm::tlm_generic_payload& payload);
  /// How long the payload's data take.
  [[nodiscard]] Time data_time(const tlm::tlm_generic_payload& payload) const;
  [[nodiscard]] Time cycles(std::int64_t count) const { return config_.clock.period() * count; }
  [[nodiscard]] std::size_t bank_of(const tlm::tlm_generic_payload& payload) const {
    return payload.get_address() / interleave_ % banks_.size();
  }

  Turns& turns_;
  Later later_;
  memory::InterconnectConfig config_;
  memory::InterconnectStatistics statistics_;  // but the waits
  Waits waits_;

 private:
  tlm::tlm_sync_enum request(int port, tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                             sc_core::sc_time& delay);
  tlm::tlm_sync_enum answer(int bank, tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                            sc_core::sc_time& delay);

  std::uint32_t interleave_;
  sc_core::sc_vector<Bank> banks_;
  sc_core::sc_vector<BankSocket> bank_sockets_;
};

/// The interconnect that the configuration names, and the banks behind it. Throws InternalError for one that
/// is not modelled.
[[nodiscard]] std::unique_ptr<Interconnect> make_interconnect(Turns& turns,
                                                              const memory::InterconnectConfig& config,
                                                              const memory::BankConfig& banks,
                                                              std::uint32_t nodes, const char* name);

}  // namespace marti::oracle
