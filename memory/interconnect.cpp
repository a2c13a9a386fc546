#include "memory/interconnect.h"

#include "memory/arbitrated_bus.h"
#include "memory/bus.h"
#include "memory/crossbar.h"
#include "memory/ideal.h"
#include "sim/error.h"

namespace marti::memory {

void Interconnect::reply(std::uint32_t /*port*/) {
  throw sim::InternalError("a reply event for an interconnect that posts none");
}

void Interconnect::prepare(std::uint32_t /*port*/) const {}

bool Interconnect::prepare_more(std::uint32_t /*port*/) const { return false; }

void Interconnect::proceed(std::uint32_t /*port*/, std::uint32_t /*sequence*/) {
  throw sim::InternalError("an event of the memory's own for an interconnect that posts none");
}

void Interconnect::count_reads(std::int64_t /*reads*/, std::int64_t /*bytes*/) {
  throw sim::InternalError("reads that an interconnect was not asked for, which it would have delayed");
}

sim::Ticks ideal_read(const InterconnectConfig& config) { return config.clock.cycles(config.latency_cycles); }

std::unique_ptr<Interconnect> make_interconnect(const InterconnectConfig& config, const BankConfig& banks,
                                                const InterconnectSite& site) {
  if (config.width == 0) {
    throw sim::UserError("an interconnect must be at least one byte wide");
  }
  if (config.kind == InterconnectKind::ideal && banks.cache) {
    throw sim::UserError(
        "an ideal interconnect has no memory behind it that a shared cache could stand before");
  }
  if (config.kind == InterconnectKind::bus && config.mode == BusMode::held && banks.dram &&
      banks.dram->policy == DramPolicy::frfcfs) {
    throw sim::UserError(
        "a DRAM has nothing to choose from on a bus that each read keeps until its data have come");
  }
  switch (config.kind) {
    case InterconnectKind::ideal:
      return std::make_unique<Ideal>(config, site);
    case InterconnectKind::crossbar:
      return std::make_unique<Crossbar>(config, banks, site);
    case InterconnectKind::bus:
      break;
  }
  if (config.arbitration != Arbitration::fifo) {
    return std::make_unique<ArbitratedBus>(config, banks, site);
  }
  return std::make_unique<Bus>(config, banks, site);
}

}  // namespace marti::memory
