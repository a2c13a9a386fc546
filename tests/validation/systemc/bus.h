// A bus: one queue of tenures, served one by one.
#pragma once

#include <deque>

#include "tests/validation/systemc/interconnect.h"

namespace marti::oracle {

class Bus final : public Interconnect, public TurnTaker {
 public:
  Bus(const sc_core::sc_module_name& name, Turns& turns, const memory::InterconnectConfig& config,
      const memory::BankConfig& banks, std::uint32_t nodes);

 private:
  /// A request's tenure, or one of a split bus's data.
  struct Tenure {
    tlm::tlm_generic_payload* payload = nullptr;
    bool data = false;
    Time asked = 0;
  };

  void accept(tlm::tlm_generic_payload& payload) override;
  void bank_ready(tlm::tlm_generic_payload& payload) override;
  void take_turn(Turn turn, std::uint32_t node) override;
  void ask(const Tenure& tenure);
  void serve();
  void begin_request(tlm::tlm_generic_payload& payload);
  void begin_data(tlm::tlm_generic_payload& payload);
  void give_back();

  std::deque<Tenure> queue_;
  bool taken_ = false;
  Time taken_at_ = 0;
  std::map<std::uint32_t, tlm::tlm_generic_payload*> data_of_;  // nodes whose data ask for the bus
};

}  // namespace marti::oracle
