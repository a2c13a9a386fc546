#include "studies/sweep/ranks/sweep_message.h"

#include "sim/error.h"
#include "studies/sweep/plan/byte_codec.h"

namespace marti::studies::sweep {

namespace {

void check(const SweepRow& row) {
  for (const SweepHistogram& histogram : row.histograms) {
    std::int64_t last = -1;
    for (const SweepHistogram::Bucket& bucket : histogram.buckets) {
      sim::ensure(bucket.lowest > last && bucket.highest >= bucket.lowest && bucket.count > 0,
                  "a message with an impossible histogram");
      last = bucket.highest;
    }
  }
}

}  // namespace

std::string encode(const SweepMessage& message) {
  const SweepTask& task = message.task;
  return ByteWriter()
      .write(static_cast<std::uint8_t>(message.kind), message.number, message.nanoseconds, message.frame,
             message.machine, message.bytes)
      .write(static_cast<std::uint8_t>(task.kind), task.frame, task.sharing, task.ways, task.machines)
      .take();
}

SweepMessage decode_sweep_message(std::string_view bytes) {
  SweepMessage message;
  SweepTask& task = message.task;
  std::uint8_t kind = 0;
  std::uint8_t task_kind = 0;
  ByteReader(bytes, "a message between ranks")
      .read(kind, message.number, message.nanoseconds, message.frame, message.machine, message.bytes)
      .read(task_kind, task.frame, task.sharing, task.ways, task.machines)
      .end();
  sim::ensure(kind <= static_cast<std::uint8_t>(SweepMessage::Kind::failed) &&
                  task_kind <= static_cast<std::uint8_t>(SweepTask::Kind::end),
              "a message of no kind");
  message.kind = static_cast<SweepMessage::Kind>(kind);
  task.kind = static_cast<SweepTask::Kind>(task_kind);
  check(message.machine);
  return message;
}

}  // namespace marti::studies::sweep
