#include "tests/validation/systemc/interconnect.h"

#include "sim/error.h"
#include "tests/validation/systemc/bus.h"
#include "tests/validation/systemc/crossbar.h"
#include "tests/validation/systemc/ideal.h"

namespace marti::oracle {

Interconnect::Interconnect(const sc_core::sc_module_name& name, Turns& turns,
                           const memory::InterconnectConfig& config, const memory::BankConfig& bank_config,
                           std::uint32_t nodes, std::uint32_t banks)
    : sc_module(name),
      sockets("socket", nodes),
      turns_(turns),
      later_("later", turns),
      config_(config),
      interleave_(bank_config.interleave),
      banks_("bank"),
      bank_sockets_("bank_socket", banks) {
  for (std::uint32_t node = 0; node < nodes; ++node) {
    sockets[node].register_nb_transport_fw(this, &Interconnect::request, static_cast<int>(node));
  }
  banks_.init(banks, [&](const char* bank, std::size_t) { return new Bank(bank, turns, bank_config); });
  for (std::uint32_t bank = 0; bank < banks; ++bank) {
    bank_sockets_[bank].register_nb_transport_bw(this, &Interconnect::answer, static_cast<int>(bank));
    bank_sockets_[bank].bind(banks_[bank].socket);
  }
}

tlm::tlm_sync_enum Interconnect::request(int port, tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                         sc_core::sc_time& /*delay*/) {
  Course& course = course_of(payload);
  course.port = port;
  course.asked = now();
  ++(payload.is_read() ? statistics_.reads : statistics_.writes);
  statistics_.bytes += payload.get_data_length();
  accept(payload);
  phase = tlm::END_REQ;
  return tlm::TLM_UPDATED;
}

tlm::tlm_sync_enum Interconnect::answer(int /*bank*/, tlm::tlm_generic_payload& payload,
                                        tlm::tlm_phase& /*phase*/, sc_core::sc_time& /*delay*/) {
  course_of(payload).ready = now();
  bank_ready(payload);
  return tlm::TLM_COMPLETED;
}

void Interconnect::send_to_bank(tlm::tlm_generic_payload& payload) {
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  sc_core::sc_time none;
  bank_sockets_[bank_of(payload)]->nb_transport_fw(payload, phase, none);
}

void Interconnect::respond(tlm::tlm_generic_payload& payload) {
  Course& course = course_of(payload);
  course.done = now();
  payload.set_response_status(tlm::TLM_OK_RESPONSE);
  tlm::tlm_phase phase = tlm::BEGIN_RESP;
  sc_core::sc_time none;
  sockets[static_cast<std::size_t>(course.port)]->nb_transport_bw(payload, phase, none);
}

Time Interconnect::data_time(const tlm::tlm_generic_payload& payload) const {
  const std::int64_t beats = (std::int64_t{payload.get_data_length()} + config_.width - 1) / config_.width;
  return cycles(beats * config_.cycles_per_beat);
}

std::unique_ptr<Interconnect> make_interconnect(Turns& turns, const memory::InterconnectConfig& config,
                                                const memory::BankConfig& banks, std::uint32_t nodes,
                                                const char* name) {
  switch (config.kind) {
    case memory::InterconnectKind::ideal:
      return std::make_unique<Ideal>(name, turns, config, banks, nodes);
    case memory::InterconnectKind::bus:
      return std::make_unique<Bus>(name, turns, config, banks, nodes);
    case memory::InterconnectKind::crossbar:
      return std::make_unique<Crossbar>(name, turns, config, banks, nodes);
  }
  throw sim::InternalError("the SystemC model has no such interconnect");
}

}  // namespace marti::oracle
