#include "scenes/pbrt_attributes.h"

#include <utility>

namespace marti::scenes::pbrt {

void Attributes::add(const std::string& made, const Parameters& parameters, const SourceFile& file) {
  auto given = given_ ? std::make_shared<OfKind>(*given_) : std::make_shared<OfKind>();
  std::vector<Parameter>& all = (*given)[made];
  for (const Parameter& parameter : parameters.all()) {
    std::erase_if(all, [&](const Parameter& before) { return before.name == parameter.name; });
    all.push_back(parameter);
  }
  for (const auto& [kind, of_kind] : *given) {
    file.take_memory(kind.size() + bytes_of(of_kind), "its attributes take");
  }
  given_ = std::move(given);
}

void Attributes::append_to(Parameters& parameters, std::string_view made) const {
  if (given_ == nullptr) {
    return;
  }
  if (const auto of_kind = given_->find(made); of_kind != given_->end()) {
    parameters.append(of_kind->second);
  }
}

}  // namespace marti::scenes::pbrt
