#include "memory/banked.h"

#include "memory/late_dram.h"
#include "sim/error.h"

namespace marti::memory {

Banked::Banked(const BankConfig& banks, const InterconnectSite& site, sim::Ticks notice, bool one_at_a_time)
    : site_(site),
      banks_(banks),
      late_(banks.dram && banks.dram->policy == DramPolicy::frfcfs
                ? std::make_unique<LateDram>(*banks.dram, site, notice)
                : nullptr),
      distance_(one_at_a_time ? notice : 0) {}

Banked::~Banked() = default;

std::vector<BankStatistics> Banked::bank_statistics() const {
  return late_ ? late_->bank_statistics() : banks_.statistics();
}

std::vector<DramStatistics> Banked::dram_statistics(sim::Ticks end) const {
  return late_ ? late_->statistics(end) : banks_.dram_statistics(end);
}

sim::Ticks Banked::end_of_write(const LateAccess& write) const { return write.ready; }

void Banked::ask_late(const Transaction& transaction, bool write, sim::Ticks arrival) {
  if (write) {
    late_->writes().made(transaction.port, transaction.address);
  } else if (cached(transaction, arrival)) {
    return;
  } else if (site_.ports == 1 && !site_.writes_meanwhile) {
    late_->ask_alone(transaction, arrival, [this](const LateAccess& access) { finish(access); });
    return;
  }
  late_->ask(transaction, write, arrival, sim::add_ticks(arrival, distance_),
             [this](const LateAccess& access) { finish(access); });
}

bool Banked::cached(const Transaction& transaction, sim::Ticks arrival) {
  if (banks_.cache() == nullptr) {
    return false;
  }
  const auto [miss, hit] = banks_.cache()->read_late(transaction.port, transaction.address, arrival);
  if (hit) {
    late_read({transaction, false, arrival, hit->start, hit->ready});
  }
  return !miss;
}

void Banked::finish(const LateAccess& access) {
  const Transaction& transaction = access.transaction;
  if (access.write) {
    late_->writes().finish(transaction.port, transaction.address, end_of_write(access), site_.client);
    return;
  }
  late_read(access);
  if (SharedCache* const cache = banks_.cache()) {
    for (const SharedCache::LateHit& read :
         cache->tell(transaction.port, transaction.address, access.ready)) {
      late_read({{.port = read.port}, false, read.arrival, read.hit.start, read.hit.ready});
    }
  }
}

void Banked::proceed(std::uint32_t /*port*/, std::uint32_t sequence) {
  sim::ensure(late() && sequence > 0, "an event of the memory's own for an interconnect that posts none");
  late_->handle(sequence - 1, [this](const LateAccess& access) { finish(access); });
}

}  // namespace marti::memory
