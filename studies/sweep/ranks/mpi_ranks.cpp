// The ranks of a program that was built with MPI.
#include <mpi.h>

#include <exception>
#include <list>
#include <thread>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "studies/sweep/ranks/launch.h"
#include "studies/sweep/ranks/ranks.h"

namespace marti::studies::sweep {

namespace {

// MPI counts bytes in an int.
constexpr std::size_t most_at_once = std::size_t{1} << 29U;
constexpr int size_tag = 1;
constexpr int part_tag = 2;

int whole(std::size_t number) { return static_cast<int>(number); }

bool joined() {
  int initialised = 0;
  int finalised = 0;
  MPI_Initialized(&initialised);
  MPI_Finalized(&finalised);
  return initialised != 0 && finalised == 0;
}

}  // namespace

/// Messages being sent. MPI may read them until it reports their completion.
struct Ranks::Outbox {
  struct Item {
    std::uint64_t size = 0;
    std::string bytes;
    std::vector<MPI_Request> requests;
  };
  std::list<Item> items;
  int exceptions = std::uncaught_exceptions();

  void clear_sent() {
    items.remove_if([](Item& item) {
      int sent = 0;
      MPI_Testall(whole(item.requests.size()), item.requests.data(), &sent, MPI_STATUSES_IGNORE);
      return sent != 0;
    });
  }
};

// MPI's default stays in force: an error of MPI itself ends the job, with MPI's message.
Ranks::Ranks() : outbox_(std::make_unique<Outbox>()) {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  int rank = 0;
  int size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  rank_ = static_cast<std::size_t>(rank);
  size_ = static_cast<std::size_t>(size);
  if (const std::uint32_t launched = launched_processes(); launched != size_) {
    throw sim::UserError(std::to_string(launched) +
                         " processes were started together, but this program's MPI sees " +
                         std::to_string(size_) +
                         ": start it with the mpirun of the MPI it was built with (Open MPI), or with "
                         "srun --mpi=pmix");
  }
  sim::ensure(provided >= MPI_THREAD_FUNNELED, "MPI cannot be used by a program with threads");
  MPI_Comm beside = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &beside);
  int local = 1;
  MPI_Comm_size(beside, &local);
  local_ = static_cast<std::size_t>(local);
  MPI_Comm_free(&beside);
}

Ranks::~Ranks() {
  outbox_->clear_sent();
  if (std::uncaught_exceptions() == outbox_->exceptions && outbox_->items.empty()) {
    MPI_Finalize();
  }
}

void Ranks::send(std::size_t to, std::string message) {
  outbox_->clear_sent();
  Outbox::Item& item = outbox_->items.emplace_back();
  item.size = message.size();
  item.bytes = std::move(message);
  MPI_Isend(&item.size, 1, MPI_UINT64_T, whole(to), size_tag, MPI_COMM_WORLD, &item.requests.emplace_back());
  for (std::size_t at = 0; at < item.bytes.size(); at += most_at_once) {
    const std::size_t bytes = std::min(most_at_once, item.bytes.size() - at);
    MPI_Isend(item.bytes.data() + at, whole(bytes), MPI_BYTE, whole(to), part_tag, MPI_COMM_WORLD,
              &item.requests.emplace_back());
  }
}

std::optional<Ranks::Message> Ranks::receive() {
  outbox_->clear_sent();
  int there = 0;
  MPI_Status status{};
  MPI_Iprobe(MPI_ANY_SOURCE, size_tag, MPI_COMM_WORLD, &there, &status);
  if (there == 0) {
    return std::nullopt;
  }
  const int from = status.MPI_SOURCE;
  std::uint64_t size = 0;
  MPI_Recv(&size, 1, MPI_UINT64_T, from, size_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  Message message{static_cast<std::size_t>(from), std::string(size, '\0')};
  for (std::size_t at = 0; at < size; at += most_at_once) {
    const std::size_t bytes = std::min(most_at_once, message.bytes.size() - at);
    MPI_Recv(message.bytes.data() + at, whole(bytes), MPI_BYTE, from, part_tag, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
  }
  return message;
}

Ranks::Message Ranks::wait() {
  for (;;) {
    if (std::optional<Message> message = receive()) {
      return *std::move(message);
    }
    std::this_thread::sleep_for(pause);
  }
}

void Ranks::flush() {
  for (outbox_->clear_sent(); !outbox_->items.empty(); outbox_->clear_sent()) {
    std::this_thread::sleep_for(pause);
  }
}

void end_all_ranks(int status) {
  if (joined()) {
    MPI_Abort(MPI_COMM_WORLD, status);
  }
}

}  // namespace marti::studies::sweep
