#include "studies/run/record/heat_files.h"

#include <array>
#include <string>

#include "studies/host/image_file.h"

namespace marti::studies::run {

void add_heat_files(const HeatMap& map, tables::PendingFiles& files) {
  std::array<std::vector<float>, heats> channels;
  for (std::size_t i = 0; i < heats; ++i) {
    channels[i] = map.figures(static_cast<Heat>(i));
  }
  const std::array<std::string, heats> names = {std::string(heat_names[0]), std::string(heat_names[1]),
                                                std::string(heat_names[2])};
  files.write("heat.exr", host::exr_file(map.width(), map.height(), names, channels));
  for (std::size_t i = 0; i < heats; ++i) {
    files.write("heat-" + names[i] + ".png",
                host::png_file(false_colour(channels[i], map.width(), map.height(), legend_of(channels[i]))));
  }
}

}  // namespace marti::studies::run
