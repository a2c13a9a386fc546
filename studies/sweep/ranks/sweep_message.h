// What the ranks of a sweep say to each other.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "studies/sweep/plan/sweep_row.h"
#include "studies/sweep/work/schedule.h"

namespace marti::studies::sweep {

/// A kind uses the members that it names.
struct SweepMessage {
  enum class Kind : std::uint8_t {
    // From rank 0.
    begin,    ///< bytes: the configuration
    task,     ///< task; `end`: there are no more tasks
    drop,     ///< number: frame whose log nobody needs any more
    goodbye,  ///< all are ready to leave
    // To rank 0.
    ready,    ///< number: worker threads; bytes: digest of the plan
    ask,      ///< for a task
    traced,   ///< number: of the frame; nanoseconds; frame
    timed,    ///< number: of the machine; nanoseconds; machine
    leaving,  ///< it has brought all its results and asks for no more tasks
    failed    ///< number: 1: the user's error, 0: ours; bytes: the message
  };
  Kind kind = Kind::ask;
  std::uint64_t number = 0;
  std::int64_t nanoseconds = 0;
  FrameRow frame{};
  SweepRow machine{};
  std::string bytes{};
  SweepTask task{};
};

[[nodiscard]] std::string encode(const SweepMessage& message);
/// Throws InternalError for bytes that are not a message.
[[nodiscard]] SweepMessage decode_sweep_message(std::string_view bytes);

}  // namespace marti::studies::sweep
