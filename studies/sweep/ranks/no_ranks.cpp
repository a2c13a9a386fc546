// The ranks of a program that was built without MPI: there is one.
#include "sim/error.h"
#include "studies/sweep/ranks/launch.h"
#include "studies/sweep/ranks/ranks.h"

namespace marti::studies::sweep {

namespace {

[[noreturn]] void none() { throw sim::InternalError("a message to another rank without MPI"); }

}  // namespace

struct Ranks::Outbox {};

Ranks::Ranks() {
  throw sim::UserError(
      std::to_string(launched_processes()) +
      " processes were started together, and this program was built without MPI: build it with Open MPI "
      "(Debian: apt install libopenmpi-dev; cmake -DMARTI_MPI=ON), or start one process only");
}
Ranks::~Ranks() = default;
// NOLINTNEXTLINE(performance-unnecessary-value-param): as with MPI, which keeps it
void Ranks::send(std::size_t /*to*/, std::string /*message*/) { none(); }
std::optional<Ranks::Message> Ranks::receive() { none(); }
Ranks::Message Ranks::wait() { none(); }
void Ranks::flush() { none(); }

void end_all_ranks(int /*status*/) {}

}  // namespace marti::studies::sweep
