// A memory bank: a queue, and a timer for when its access is ready and when the next may begin.
#pragma once

#include <deque>
#include <systemc>
#include <tlm>

#include <tlm_utils/simple_target_socket.h>

#include "memory/bank.h"
#include "tests/validation/systemc/transport.h"

namespace marti::oracle {

class Bank : public sc_core::sc_module {
 public:
  Bank(const sc_core::sc_module_name& name, Turns& turns, const memory::BankConfig& config)
      : sc_module(name),
        socket("socket"),
        later_("later", turns),
        access_(config.clock.period() * config.access_cycles),
        busy_(config.clock.period() * config.busy_cycles) {
    socket.register_nb_transport_fw(this, &Bank::arrive);
  }

  tlm_utils::simple_target_socket<Bank> socket;

  [[nodiscard]] const memory::BankStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const Waits& waits() const { return waits_; }

 private:
  tlm::tlm_sync_enum arrive(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                            sc_core::sc_time& /*delay*/) {
    course_of(payload).sent = now();
    queue_.push_back(&payload);
    serve();
    phase = tlm::END_REQ;
    return tlm::TLM_UPDATED;
  }

  void serve() {
    if (serving_ || queue_.empty()) {
      return;
    }
    tlm::tlm_generic_payload& payload = *queue_.front();
    queue_.pop_front();
    serving_ = true;
    Course& course = course_of(payload);
    course.bank_start = now();
    waits_.add(course.bank_start - course.sent);
    ++statistics_.accesses;
    statistics_.busy += busy_;
    later_.after(access_, [this, &payload] {
      tlm::tlm_phase phase = tlm::BEGIN_RESP;
      sc_core::sc_time none;
      payload.set_response_status(tlm::TLM_OK_RESPONSE);
      socket->nb_transport_bw(payload, phase, none);
    });
    later_.after(busy_, [this] {
      serving_ = false;
      serve();
    });
  }

  Later later_;
  Time access_;
  Time busy_;
  std::deque<tlm::tlm_generic_payload*> queue_;
  bool serving_ = false;
  memory::BankStatistics statistics_;  // but the waits
  Waits waits_;
};

}  // namespace marti::oracle
