// What goes over the TLM sockets: generic payloads that carry their course with them.
//
// The base protocol with four phases, of which the target ends the request at once (TLM_UPDATED, END_REQ) and
// the initiator the response (TLM_COMPLETED): waiting happens in the components' queues, where it is counted.
// Tags alone are simulated, so a payload has a length and no data.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <systemc>
#include <tlm>
#include <vector>

#include "sim/error.h"
#include "tests/validation/systemc/instant.h"

namespace marti::oracle {

/// When a transaction passed each point of its way. A point that a component lacks takes no time.
struct Course : tlm::tlm_extension<Course> {
  std::uint32_t node = 0;  ///< of the machine
  int port = 0;            ///< of its cluster's interconnect
  Time asked = 0;          ///< it reached the interconnect
  Time granted = 0;        ///< it began to move
  Time sent = 0;           ///< it arrived at the bank
  Time bank_start = 0;     ///< the bank began
  Time ready = 0;          ///< the bank had it done
  Time data_start = 0;     ///< its data began to move
  Time done = 0;

  tlm_extension_base* clone() const override { return new Course(*this); }
  void copy_from(const tlm_extension_base& other) override { *this = dynamic_cast<const Course&>(other); }
};

[[nodiscard]] inline Course& course_of(tlm::tlm_generic_payload& payload) {
  Course* const course = payload.get_extension<Course>();
  sim::ensure(course != nullptr, "a payload has no course");
  return *course;
}

/// The waits at one queue: how often each.
class Waits {
 public:
  void add(Time wait) {
    sim::ensure(wait >= 0, "a wait is negative");
    ++times_[wait];
  }
  [[nodiscard]] const std::map<Time, std::int64_t>& times() const { return times_; }

 private:
  std::map<Time, std::int64_t> times_;
};

/// Payloads that are used again and again.
class PayloadPool : public tlm::tlm_mm_interface {
 public:
  tlm::tlm_generic_payload& take(tlm::tlm_command command, std::uint64_t address, std::uint64_t bytes,
                                 std::uint32_t node) {
    if (unused_.empty()) {
      all_.push_back(std::make_unique<tlm::tlm_generic_payload>(this));
      all_.back()->set_extension(new Course);
      unused_.push_back(all_.back().get());
    }
    tlm::tlm_generic_payload& payload = *unused_.back();
    unused_.pop_back();
    payload.acquire();
    payload.set_command(command);
    payload.set_address(address);
    payload.set_data_length(static_cast<unsigned>(bytes));
    payload.set_streaming_width(static_cast<unsigned>(bytes));
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    course_of(payload).node = node;
    return payload;
  }
  void free(tlm::tlm_generic_payload* payload) override { unused_.push_back(payload); }

 private:
  std::vector<std::unique_ptr<tlm::tlm_generic_payload>> all_;
  std::vector<tlm::tlm_generic_payload*> unused_;
};

}  // namespace marti::oracle
