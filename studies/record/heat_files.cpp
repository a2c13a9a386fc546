#include "studies/record/heat_files.h"

#include <array>
#include <string>

#include "studies/image_file.h"

namespace marti::studies {

HeatFiles::HeatFiles(const HeatMap& map, const std::filesystem::path& directory) {
  const auto pending = [&](const std::string& name) -> const std::filesystem::path& {
    files_.push_back(directory / name);
    pending_.push_back(std::make_unique<sim::PendingFile>(files_.back()));
    return pending_.back()->temporary();
  };
  std::array<std::vector<float>, heats> channels;
  for (std::size_t i = 0; i < heats; ++i) {
    channels[i] = map.figures(static_cast<Heat>(i));
  }
  const std::array<std::string, heats> names = {std::string(heat_names[0]), std::string(heat_names[1]),
                                                std::string(heat_names[2])};
  write_channels(map.width(), map.height(), names, channels, pending("heat.exr"));
  for (std::size_t i = 0; i < heats; ++i) {
    write_png(false_colour(channels[i], map.width(), map.height(), legend_of(channels[i])),
              pending("heat-" + names[i] + ".png"));
  }
}

void HeatFiles::commit() {
  for (const std::unique_ptr<sim::PendingFile>& file : pending_) {
    file->commit();
  }
}

}  // namespace marti::studies
