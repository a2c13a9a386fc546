// The log of a frame in the place of its scene: which keys it decides (`scene.log`).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "processors/program/render.h"
#include "sim/config.h"
#include "studies/log_file/log_fields.h"

namespace marti::studies::keys {

/// The file of a log, as it was when the configuration was read.
struct LoggedFrame {
  std::filesystem::path file;
  std::uint64_t id = 0;  ///< of its content (packed_file.h)
  log_file::LogHead head;
};

/// What a frame is read for. Machines can be timed on a log; all else needs the scene itself.
enum class FrameUse : std::uint8_t { timing, operations, paper, frames, error, stability };

/// The log that `scene.log` names; null where it is not given. Gives each key that decides a scene, a
/// structure or an image the value that the log was made with. Throws UserError, naming file, line and key,
/// for a file that is no log, for a key that has another value, and for a use other than timing. Where the
/// command names the log, keys of the configuration's file may have other values, and do not count.
[[nodiscard]] std::shared_ptr<const LoggedFrame> read_log(sim::Config& config, FrameUse use);

/// Throws UserError unless the log has what the machine's nodes need, as `render` says; then sets `render` to
/// what it has.
void check_recorded(const sim::Config& config, const LoggedFrame& log,
                    processors::program::RenderOptions& render);

/// Whether a log decides the key's value, and keeps it.
[[nodiscard]] bool is_kept_in_log(std::string_view key);

}  // namespace marti::studies::keys
