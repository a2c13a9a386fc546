// A traced frame as a file: its work log, and what a run says of its scene (docs/scenes.md).
#pragma once

#include <span>

#include "sim/config.h"
#include "studies/keys/frame_keys.h"
#include "studies/log_file/packed_file.h"
#include "studies/run/functional_run.h"

namespace marti::studies::run {

/// Writes the frame, which `render` recorded, with those of `values` that decide it. Throws UserError when
/// the file cannot be written.
void save_frame(const FunctionalRun& frame, const processors::program::RenderOptions& render,
                std::span<const sim::EffectiveValue> values, log_file::PackedWriter& file);

/// The frame of the log that `config` names: it has all but the pixels of its image. Throws UserError for a
/// log that has changed since `config` was read, that is no log of such a frame, that breaks a rule of logs
/// (log_rules.h), or that takes more than the memory limit; and where `config` keeps what is left out when a
/// frame is traced.
[[nodiscard]] FunctionalRun open_saved_frame(const keys::FrameConfig& config);

}  // namespace marti::studies::run
