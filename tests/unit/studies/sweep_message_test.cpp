// Messages between ranks.
#include "studies/sweep/ranks/sweep_message.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sim/error.h"

namespace marti::studies {
namespace {

RC_GTEST_PROP(SweepMessage, ComesBack,
              (std::uint64_t number, std::int64_t nanoseconds, const std::string& row,
               const std::string& bytes, const std::vector<std::size_t>& machines)) {
  SweepMessage message{static_cast<SweepMessage::Kind>(number % 10), number, nanoseconds, row, bytes, {}};
  message.task = {static_cast<SweepTask::Kind>(number % 4), machines.size(), machines, number / 3};
  const std::string sent = encode(message);
  const SweepMessage back = decode_sweep_message(sent);
  RC_ASSERT(back.kind == message.kind);
  RC_ASSERT(back.number == number);
  RC_ASSERT(back.nanoseconds == nanoseconds);
  RC_ASSERT(back.row == row);
  RC_ASSERT(back.bytes == bytes);
  RC_ASSERT(back.task.kind == message.task.kind);
  RC_ASSERT(back.task.frame == message.task.frame);
  RC_ASSERT(back.task.machines == machines);
  RC_ASSERT(back.task.sharing == message.task.sharing);
  const std::size_t length = *rc::gen::inRange<std::size_t>(0, sent.size());
  RC_ASSERT_THROWS_AS(decode_sweep_message(sent.substr(0, length)), sim::InternalError);
  RC_ASSERT_THROWS_AS(decode_sweep_message(sent + "x"), sim::InternalError);
}

}  // namespace
}  // namespace marti::studies
