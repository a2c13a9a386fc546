// An error about a part of a scene that was asked for and does not exist.
#pragma once

#include <string>

#include "sim/error.h"

namespace marti::scenes {

/// The fault lies in the choice, not in the scene; the code that made the choice adds its place.
class PartError : public sim::UserError {
 public:
  /// The field of FileOptions that holds the choice: "scene", "camera", "animation" or "time", or
  /// of its view: "eye", "look_at" or "up".
  PartError(std::string part, const std::string& message) : sim::UserError(message), part_(std::move(part)) {}

  [[nodiscard]] const std::string& part() const { return part_; }

 private:
  std::string part_;
};

}  // namespace marti::scenes
