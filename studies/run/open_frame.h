// Opening the scene of a frame, with errors reported under the key that asks for it.
#pragma once

#include "scenes/open.h"
#include "scenes/part_error.h"
#include "sim/key_error.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::run {

/// Calls `work`. If a UserError from it names no key, it becomes a sim::KeyError about the key that asks for
/// the missing part of the scene, or about scene.source.
template <class Work>
decltype(auto) with_scene_keys(const Work& work) {
  return sim::KeyError::reported_under("scene.source", [&]() -> decltype(auto) {
    try {
      return work();
    } catch (const scenes::PartError& error) {
      throw sim::KeyError(error.part() == "time" ? "frames.first" : "scene." + error.part(), error.what());
    }
  });
}

/// Opens the scene in its first pose. `use` is as in scenes::open_scene.
[[nodiscard]] scenes::Scene open_frame(const keys::FrameConfig& frame, scenes::FileUse* use = nullptr);

}  // namespace marti::studies::run
