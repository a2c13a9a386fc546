#include "memory/banked.h"

#include "sim/error.h"

namespace marti::memory {

void Banked::ask_late(const Transaction& transaction, bool write, sim::Ticks arrival) {
  if (write) {
    writes_.made(transaction.port, transaction.address);
  }
  late_->ask(transaction, write, arrival);
}

void Banked::proceed(std::uint32_t /*port*/, std::uint32_t sequence) {
  sim::ensure(late() && sequence > 0, "an event of the memory's own for an interconnect that posts none");
  late_->proceed(sequence - 1, [this](const LateAccess& access) {
    if (access.write) {
      const Transaction& write = access.transaction;
      writes_.finish(write.port, write.address, end_of_write(access), site_.client);
    } else {
      late_read(access);
    }
  });
}

}  // namespace marti::memory
