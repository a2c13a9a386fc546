// An interconnect on which nothing waits, with memory that is always ready.
#pragma once

#include "tests/validation/systemc/interconnect.h"

namespace marti::oracle {

class Ideal final : public Interconnect {
 public:
  Ideal(const sc_core::sc_module_name& name, Turns& turns, const memory::InterconnectConfig& config,
        const memory::BankConfig& banks, std::uint32_t nodes)
      : Interconnect(name, turns, config, banks, nodes, 0) {
    statistics_.links = nodes;
  }

 private:
  void accept(tlm::tlm_generic_payload& payload) override {
    waits_.add(0);
    statistics_.busy += cycles(config_.latency_cycles);
    statistics_.held += cycles(config_.latency_cycles);
    later_.after(cycles(config_.latency_cycles), [this, &payload] {
      Course& course = course_of(payload);
      course.granted = course.asked;
      course.sent = course.bank_start = course.ready = course.data_start = now();
      respond(payload);
    });
  }
  void bank_ready(tlm::tlm_generic_payload& /*payload*/) override {
    throw sim::InternalError("there are no banks");
  }
};

}  // namespace marti::oracle
