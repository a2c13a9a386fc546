#include "studies/compare/frames.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string>

namespace marti::studies::compare {

namespace {

bool has_hashes(const ComparedResult& result) {
  return result.figures.contains("frame.image_hash") && result.figures.contains("frame.hit_hash");
}

// The settings of the frame, in order.
std::vector<std::pair<std::string, std::string>> settings_of_frame(const ComparedResult& result) {
  std::vector<std::pair<std::string, std::string>> settings;
  std::ranges::copy_if(result.settings, std::back_inserter(settings),
                       [](const auto& setting) { return is_frame_setting(setting.first); });
  return settings;
}

}  // namespace

bool is_frame_setting(std::string_view key) {
  constexpr std::array<std::string_view, 4> sections = {"scene", "frames", "image", "structure"};
  return std::ranges::find(sections, key.substr(0, key.find('.'))) != sections.end();
}

bool same_frame(const ComparedResult& a, const ComparedResult& b) {
  if (!has_hashes(a) || !has_hashes(b)) {
    return settings_of_frame(a) == settings_of_frame(b);
  }
  constexpr std::array<const char*, 4> identity = {"frame.image_hash", "frame.hit_hash", "frame.width",
                                                   "frame.height"};
  const auto value = [](const ComparedResult& result, const char* name) {
    const auto at = result.figures.find(name);
    return at == result.figures.end() ? tables::Cell() : at->second;
  };
  // Images and hits of two scenes can be equal where they differ in what no ray meets.
  return (a.scene_hash.empty() || b.scene_hash.empty() || a.scene_hash == b.scene_hash) &&
         std::ranges::all_of(identity, [&](const char* name) { return value(a, name) == value(b, name); });
}

std::vector<Difference> frame_settings(const std::vector<Difference>& settings) {
  std::vector<Difference> found;
  std::ranges::copy_if(settings, std::back_inserter(found),
                       [](const Difference& setting) { return is_frame_setting(setting.name); });
  return found;
}

}  // namespace marti::studies::compare
