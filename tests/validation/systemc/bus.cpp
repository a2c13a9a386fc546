#include "tests/validation/systemc/bus.h"

namespace marti::oracle {

Bus::Bus(const sc_core::sc_module_name& name, Turns& turns, const memory::InterconnectConfig& config,
         const memory::BankConfig& banks, std::uint32_t nodes)
    : Interconnect(name, turns, config, banks, nodes, banks.count) {
  sim::ensure(config.mode == memory::BusMode::held || config.mode == memory::BusMode::split,
              "the SystemC model has no such bus");
  statistics_.links = 1;
}

void Bus::accept(tlm::tlm_generic_payload& payload) { ask({&payload, false, now()}); }

void Bus::ask(const Tenure& tenure) {
  queue_.push_back(tenure);
  serve();
}

void Bus::serve() {
  if (taken_ || queue_.empty()) {
    return;
  }
  const Tenure tenure = queue_.front();
  queue_.pop_front();
  taken_ = true;
  taken_at_ = now();
  waits_.add(now() - tenure.asked);
  if (tenure.data) {
    begin_data(*tenure.payload);
  } else {
    begin_request(*tenure.payload);
  }
}

void Bus::begin_request(tlm::tlm_generic_payload& payload) {
  course_of(payload).granted = now();
  const bool keeps_bus = payload.is_read() && config_.mode == memory::BusMode::held;
  const Time data = payload.is_write() ? data_time(payload) : 0;
  later_.after(cycles(config_.address_cycles) + data, [this, &payload, keeps_bus] {
    send_to_bank(payload);
    statistics_.data += payload.is_write() ? data_time(payload) : 0;
    if (!keeps_bus) {
      give_back();
    }
  });
}

void Bus::bank_ready(tlm::tlm_generic_payload& payload) {
  if (payload.is_write()) {
    respond(payload);
  } else if (config_.mode == memory::BusMode::held) {
    statistics_.held += now() - course_of(payload).sent;
    begin_data(payload);
  } else {
    const std::uint32_t node = course_of(payload).node;
    data_of_[node] = &payload;
    turns_.ask(Turn::reply, node, *this);
  }
}

void Bus::take_turn(Turn /*turn*/, std::uint32_t node) {
  ask({data_of_.extract(node).mapped(), true, now()});
}

void Bus::begin_data(tlm::tlm_generic_payload& payload) {
  course_of(payload).data_start = now();
  later_.after(data_time(payload), [this, &payload] {
    statistics_.data += data_time(payload);
    give_back();
    respond(payload);
  });
}

void Bus::give_back() {
  statistics_.busy += now() - taken_at_;
  taken_ = false;
  serve();
}

}  // namespace marti::oracle
