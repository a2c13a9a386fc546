// Ports of an interconnect that issue given transactions at given times and record when they were served.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "memory/interconnect.h"
#include "sim/engine.h"

namespace marti::test {

inline constexpr std::uint8_t reply_class = 2;
inline constexpr std::uint8_t issue_class = 3;
inline constexpr std::uint8_t memory_class = 4;

struct IssuedTransaction {
  sim::Ticks at = 0;
  memory::Transaction transaction;
  bool write = false;
};

class Ports : public memory::InterconnectClient, public sim::EventHandler {
 public:
  /// Runs all of it; `make` makes the interconnect at its site.
  template <class Make>
  Ports(const Make& make, std::vector<IssuedTransaction> issues, std::uint32_t ports)
      : issues_(std::move(issues)), services(ports), written(ports) {
    interconnect = make(memory::InterconnectSite{engine, *this, reply_class, 0, ports, memory_class});
    for (const std::uint8_t c : {reply_class, issue_class, memory_class}) {
      engine.attach(c, *this);
    }
    for (std::uint32_t i = 0; i < issues_.size(); ++i) {
      engine.post(sim::Event::make(issues_[i].at, issue_class, issues_[i].transaction.port, i));
    }
    engine.run(100'000);
  }
  Ports(const memory::InterconnectConfig& config, const memory::BankConfig& banks,
        std::vector<IssuedTransaction> issues, std::uint32_t ports = 64)
      : Ports([&](const memory::InterconnectSite& site) { return make_interconnect(config, banks, site); },
              std::move(issues), ports) {}

  void handle(const sim::Event& event) override {
    if (event.event_class() == reply_class) {
      interconnect->reply(event.component());
    } else if (event.event_class() == memory_class) {
      interconnect->proceed(event.component(), event.sequence());
    } else {
      const IssuedTransaction& issue = issues_[event.sequence()];
      issue.write ? interconnect->write(issue.transaction) : interconnect->read(issue.transaction);
    }
  }
  void read_done(std::uint32_t port, const memory::Service& service) override {
    services[port].push_back(service);
    end = std::max(end, service.done);
  }
  void write_done(std::uint32_t port, sim::Ticks done) override {
    written[port].push_back(done);
    end = std::max(end, done);
  }

 private:
  std::vector<IssuedTransaction> issues_;

 public:
  sim::Engine engine;
  std::unique_ptr<memory::Interconnect> interconnect;
  std::vector<std::vector<memory::Service>> services;  ///< of each port, in order
  std::vector<std::vector<sim::Ticks>> written;
  sim::Ticks end = 0;
};

}  // namespace marti::test
