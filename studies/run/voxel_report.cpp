#include "studies/run/voxel_report.h"

#include <algorithm>
#include <cmath>

#include "sim/error.h"

namespace marti::studies::run {

DatabaseUse database_use(const processors::program::WorkLog& log) {
  using processors::program::Step;
  const std::vector<accel::TopologyNode>& nodes = log.topology.nodes;
  std::vector<bool> read(nodes.size());
  std::vector<bool> tested(log.primitives);
  std::vector<bool> voxel_read(log.voxels);
  std::vector<bool> listed(nodes.size());
  const std::uint32_t first_voxel = log.materials - log.voxels;
  for (const processors::program::LogRow& row : log.rows) {
    for (std::size_t at = 0; at < row.words.size();
         at += processors::program::step_words(row.words.data() + at)) {
      const Step step = processors::program::step_of(row.words[at]);
      const std::uint32_t operand = processors::program::operand_of(row.words[at]);
      switch (step) {
        case Step::branch:
        case Step::transform:
        case Step::cut:
          read[operand] = true;
          break;
        case Step::leaf:
        case Step::partial_leaf:
        case Step::mailed_leaf:
          // A leaf tested in part counts as tested: which part depends on the order of its list.
          read[operand] = true;
          listed[operand] = true;
          break;
        case Step::shade:
        case Step::pass:
          if (operand >= first_voxel) {
            voxel_read[operand - first_voxel] = true;
          }
          break;
        case Step::ray:
        case Step::light:
        case Step::texel:
        case Step::any_hit:
          break;
      }
    }
  }
  DatabaseUse use;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].level > use.level_nodes.size()) {
      use.level_nodes.resize(nodes[n].level);
    }
    if (!read[n]) {
      continue;
    }
    ++use.nodes;
    ++use.level_nodes[nodes[n].level - 1U];
    if (listed[n]) {
      use.entries += nodes[n].count;
      for (std::uint32_t k = 0; k < nodes[n].count; ++k) {
        tested[log.topology.entries[nodes[n].first + k]] = true;
      }
    }
  }
  use.primitives = static_cast<std::uint64_t>(std::ranges::count(tested, true));
  use.voxels = static_cast<std::uint64_t>(std::ranges::count(voxel_read, true));
  return use;
}

ImageError image_error(const processors::program::Image& image, const processors::program::Image& exact) {
  sim::ensure(image.width == exact.width && image.height == exact.height,
              "image error: images of different sizes");
  ImageError error;
  double squares = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    double most = 0.0;
    for (int channel = 0; channel < 3; ++channel) {
      const double difference = static_cast<double>(image.pixels[i][channel]) - exact.pixels[i][channel];
      squares += difference * difference;
      most = std::max(most, std::abs(difference));
    }
    error.largest = std::max(error.largest, most);
    error.changed += image.pixels[i] != exact.pixels[i] ? 1U : 0U;
    error.visible += most > 1.0 / 255.0 ? 1U : 0U;
  }
  if (!image.pixels.empty()) {
    error.rmse = std::sqrt(squares / (3.0 * static_cast<double>(image.pixels.size())));
  }
  return error;
}

}  // namespace marti::studies::run
