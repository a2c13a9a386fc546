#include "studies/compare/alike.h"

#include <algorithm>
#include <map>
#include <string>

namespace marti::studies::compare {

SharedDifferences take_alike(std::span<std::vector<Difference>* const> lists) {
  std::map<std::string, std::vector<const Difference*>> by_name;
  for (const std::vector<Difference>* list : lists) {
    for (const Difference& difference : *list) {
      by_name[difference.name].push_back(&difference);
    }
  }
  SharedDifferences found;
  for (const auto& [name, differences] : by_name) {
    const Difference& first = *differences.front();
    const bool alike = differences.size() == lists.size() &&
                       std::ranges::all_of(differences, [&first](const Difference* other) {
                         return other->a == first.a && other->b == first.b;
                       });
    const auto both = std::ranges::find_if(differences, [](const Difference* difference) {
      return difference->a != tables::Cell() && difference->b != tables::Cell();
    });
    (alike ? found.alike : found.varied).push_back(both == differences.end() ? first : **both);
  }
  for (std::vector<Difference>* list : lists) {
    std::erase_if(*list, [&found](const Difference& difference) {
      return std::ranges::any_of(found.alike,
                                 [&](const Difference& alike) { return alike.name == difference.name; });
    });
  }
  return found;
}

}  // namespace marti::studies::compare
