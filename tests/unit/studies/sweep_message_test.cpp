// Messages between ranks.
#include "studies/sweep/ranks/sweep_message.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sim/error.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace sweep;

namespace {

SweepMessage made_message(std::uint64_t seed, const std::string& bytes) {
  test::Random random(seed);
  SweepMessage message{.kind = static_cast<SweepMessage::Kind>(seed % 10),
                       .number = random(),
                       .nanoseconds = static_cast<std::int64_t>(random()),
                       .frame = test::made_frame_row(seed % 3),
                       .machine = test::random_sweep_row(random),
                       .bytes = bytes};
  message.frame.scene = std::string(seed % 40, '\0');
  const std::vector<std::size_t> machines(seed % 5, random());
  message.task = {static_cast<SweepTask::Kind>(seed % 4), random(), machines, random()};
  return message;
}

RC_GTEST_PROP(SweepMessage, ComesBack, (std::uint64_t seed, const std::string& bytes)) {
  const SweepMessage message = made_message(seed, bytes);
  const SweepMessage back = decode_sweep_message(encode(message));
  RC_ASSERT(back.kind == message.kind);
  RC_ASSERT(back.number == message.number);
  RC_ASSERT(back.nanoseconds == message.nanoseconds);
  RC_ASSERT(back.frame == message.frame);
  RC_ASSERT(back.machine == message.machine);
  RC_ASSERT(back.bytes == message.bytes);
  RC_ASSERT(back.task.kind == message.task.kind);
  RC_ASSERT(back.task.frame == message.task.frame);
  RC_ASSERT(back.task.machines == message.task.machines);
  RC_ASSERT(back.task.sharing == message.task.sharing);
}

// Garbled bytes are refused or are the bytes of another message; nothing else happens.
RC_GTEST_PROP(SweepMessage, BytesThatAreNoMessageAreRefused, (std::uint64_t seed)) {
  const std::string sent = encode(made_message(seed, "bytes"));
  test::Random random(seed);
  const std::size_t cut = random() % sent.size();
  RC_ASSERT_THROWS_AS(decode_sweep_message(sent.substr(0, cut)), sim::InternalError);
  RC_ASSERT_THROWS_AS(decode_sweep_message(sent + "x"), sim::InternalError);
  std::string other = sent;
  other[random() % other.size()] ^= static_cast<char>(1 + random() % 255);
  try {
    RC_ASSERT(encode(decode_sweep_message(other)) == other);
  } catch (const sim::InternalError&) {
    return;
  }
}

}  // namespace
}  // namespace marti::studies
