#include "memory/banked.h"

#include "memory/late_dram.h"
#include "sim/error.h"

namespace marti::memory {

Banked::Banked(const BankConfig& banks, const InterconnectSite& site, sim::Ticks notice)
    : site_(site),
      banks_(banks),
      late_(banks.dram && banks.dram->policy == DramPolicy::frfcfs
                ? std::make_unique<LateDram>(*banks.dram, site, notice)
                : nullptr) {}

Banked::~Banked() = default;

const std::vector<BankStatistics>& Banked::bank_statistics() const {
  return late_ ? late_->bank_statistics() : banks_.statistics();
}

std::vector<DramStatistics> Banked::dram_statistics() const {
  return late_ ? late_->statistics() : banks_.dram_statistics();
}

sim::Ticks Banked::end_of_write(const LateAccess& write) const { return write.ready; }

void Banked::ask_late(const Transaction& transaction, bool write, sim::Ticks arrival) {
  if (write) {
    late_->writes().made(transaction.port, transaction.address);
  }
  if (site_.ports == 1 && !write) {
    late_->ask_alone(transaction, arrival, [this](const LateAccess& access) { finish(access); });
    return;
  }
  late_->ask(transaction, write, arrival);
}

void Banked::finish(const LateAccess& access) {
  if (access.write) {
    const Transaction& write = access.transaction;
    late_->writes().finish(write.port, write.address, end_of_write(access), site_.client);
  } else {
    late_read(access);
  }
}

void Banked::proceed(std::uint32_t /*port*/, std::uint32_t sequence) {
  sim::ensure(late() && sequence > 0, "an event of the memory's own for an interconnect that posts none");
  late_->proceed(sequence - 1, [this](const LateAccess& access) { finish(access); });
}

}  // namespace marti::memory
