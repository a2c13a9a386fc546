#include "studies/sweep/ranks/sweep_message.h"

#include "sim/error.h"
#include "studies/sweep/plan/byte_parts.h"

namespace marti::studies {

std::string encode(const SweepMessage& message) {
  ByteWriter out;
  out.reserve(message.row.size() + message.bytes.size() + 128 +
              message.task.machines.size() * sizeof(std::uint64_t));
  out.number(static_cast<std::uint8_t>(message.kind));
  out.number(message.number);
  out.number(message.nanoseconds);
  out.text(message.row);
  out.text(message.bytes);
  out.number(static_cast<std::uint8_t>(message.task.kind));
  out.number(std::uint64_t{message.task.frame});
  out.number(std::uint64_t{message.task.sharing});
  out.number(std::uint64_t{message.task.ways.size()});
  for (const std::uint32_t ways : message.task.ways) {
    out.number(ways);
  }
  out.number(std::uint64_t{message.task.machines.size()});
  for (const std::size_t machine : message.task.machines) {
    out.number(std::uint64_t{machine});
  }
  return out.bytes();
}

SweepMessage decode_sweep_message(std::string_view bytes) {
  try {
    ByteReader in(bytes);
    SweepMessage message;
    const auto kind = in.number<std::uint8_t>();
    message.number = in.number<std::uint64_t>();
    message.nanoseconds = in.number<std::int64_t>();
    message.row = in.text();
    message.bytes = in.text();
    const auto task = in.number<std::uint8_t>();
    message.task.frame = in.number<std::uint64_t>();
    message.task.sharing = in.number<std::uint64_t>();
    message.task.ways.resize(in.count(sizeof(std::uint32_t)));
    for (std::uint32_t& ways : message.task.ways) {
      ways = in.number<std::uint32_t>();
    }
    message.task.machines.resize(in.count(sizeof(std::uint64_t)));
    for (std::size_t& machine : message.task.machines) {
      machine = in.number<std::uint64_t>();
    }
    in.end();
    sim::ensure(kind <= static_cast<std::uint8_t>(SweepMessage::Kind::failed) &&
                    task <= static_cast<std::uint8_t>(SweepTask::Kind::end),
                "a message of no kind");
    message.kind = static_cast<SweepMessage::Kind>(kind);
    message.task.kind = static_cast<SweepTask::Kind>(task);
    return message;
  } catch (const DamagedBytes& damage) {
    throw sim::InternalError(std::string("a message between ranks: ") + damage.what());
  }
}

}  // namespace marti::studies
