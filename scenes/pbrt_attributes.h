// Internal to scenes/: the parameters that pbrt's statement Attribute gives to statements after it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/pbrt_text.h"
#include "scenes/source_file.h"

namespace marti::scenes::pbrt {

/// A part of the state that AttributeBegin saves; copies share what they have.
class Attributes {
 public:
  /// For all that is made of this kind: "shape", "light", "material", "medium" or "texture". Of parameters
  /// with one name the last counts. Throws UserError when they take too much memory.
  void add(const std::string& made, const Parameters& parameters, const SourceFile& file);
  /// Puts those for what is made behind the parameters of a statement, which come first.
  void append_to(Parameters& parameters, std::string_view made) const;

 private:
  using OfKind = std::map<std::string, std::vector<Parameter>, std::less<>>;
  std::shared_ptr<const OfKind> given_;  // null: none
};

}  // namespace marti::scenes::pbrt
