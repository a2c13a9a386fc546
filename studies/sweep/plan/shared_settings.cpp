#include "studies/sweep/plan/shared_settings.h"

#include <iterator>
#include <string_view>
#include <utility>

#include "studies/sweep/plan/digest.h"

namespace marti::studies::sweep {

std::string_view section_of(std::string_view key) { return key.substr(0, key.rfind('.')); }

SharedSettings SettingsPool::share(std::vector<sim::EffectiveValue> settings) {
  SharedSettings shared;
  for (auto begin = settings.begin(); begin != settings.end();) {
    ByteWriter content;
    auto end = begin;
    for (; end != settings.end() && section_of(end->key) == section_of(begin->key); ++end) {
      content.write(end->key, end->value, end->given, end->source);
    }
    SettingsPart& part = parts_[content.take()];
    if (part == nullptr) {
      part = std::make_shared<const std::vector<sim::EffectiveValue>>(std::make_move_iterator(begin),
                                                                      std::make_move_iterator(end));
    }
    shared.push_back(part);
    begin = end;
  }
  shared.shrink_to_fit();
  return shared;
}

std::vector<sim::EffectiveValue> all_of(const SharedSettings& settings) {
  std::vector<sim::EffectiveValue> all;
  for (const SettingsPart& part : settings) {
    all.insert(all.end(), part->begin(), part->end());
  }
  return all;
}

}  // namespace marti::studies::sweep
