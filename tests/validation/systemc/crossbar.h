// A crossbar: every node reaches every bank after the latency; the data of each bank's reads share a link.
#pragma once

#include <deque>
#include <vector>

#include "tests/validation/systemc/interconnect.h"

namespace marti::oracle {

class Crossbar final : public Interconnect {
 public:
  Crossbar(const sc_core::sc_module_name& name, Turns& turns, const memory::InterconnectConfig& config,
           const memory::BankConfig& banks, std::uint32_t nodes)
      : Interconnect(name, turns, config, banks, nodes, banks.count), links_(banks.count) {
    statistics_.links = banks.count;
  }

 private:
  struct Link {
    std::deque<tlm::tlm_generic_payload*> queue;
    bool taken = false;
  };

  void accept(tlm::tlm_generic_payload& payload) override {
    course_of(payload).granted = now();
    later_.after(cycles(config_.latency_cycles), [this, &payload] { send_to_bank(payload); });
  }

  void bank_ready(tlm::tlm_generic_payload& payload) override {
    if (payload.is_write()) {
      waits_.add(0);
      later_.after(data_time(payload), [this, &payload] { respond(payload); });
      return;
    }
    Link& link = links_[bank_of(payload)];
    link.queue.push_back(&payload);
    serve(link);
  }

  void serve(Link& link) {
    if (link.taken || link.queue.empty()) {
      return;
    }
    tlm::tlm_generic_payload& payload = *link.queue.front();
    link.queue.pop_front();
    link.taken = true;
    Course& course = course_of(payload);
    course.data_start = now();
    waits_.add(course.data_start - course.ready);
    later_.after(data_time(payload), [this, &payload, &link] {
      statistics_.busy += data_time(payload);
      statistics_.data += data_time(payload);
      later_.after(cycles(config_.latency_cycles), [this, &payload] { respond(payload); });
      link.taken = false;
      serve(link);
    });
  }

  std::vector<Link> links_;
};

}  // namespace marti::oracle
