// What was asked for of a scene and is not there.
#pragma once

#include <string>

#include "sim/error.h"

namespace marti::scenes {

/// The choice is wrong, not the scene: whoever asked for it knows where.
class PartError : public sim::UserError {
 public:
  /// The field of GltfOptions that holds the choice: "scene", "camera", "animation" or "time".
  PartError(std::string part, const std::string& message) : sim::UserError(message), part_(std::move(part)) {}

  [[nodiscard]] const std::string& part() const { return part_; }

 private:
  std::string part_;
};

}  // namespace marti::scenes
