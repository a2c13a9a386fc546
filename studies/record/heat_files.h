// The files of a heat map.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "sim/files.h"
#include "studies/record/heat_map.h"

namespace marti::studies {

/// Writes heat.exr, with a channel for each Heat, and heat-cycles.png, heat-misses.png and heat-waits.png in
/// false colours, under temporary names; commit() gives them their own. Throws UserError with the reason.
class HeatFiles {
 public:
  HeatFiles(const HeatMap& map, const std::filesystem::path& directory);
  void commit();
  [[nodiscard]] const std::vector<std::filesystem::path>& files() const { return files_; }

 private:
  std::vector<std::filesystem::path> files_;
  std::vector<std::unique_ptr<sim::PendingFile>> pending_;
};

}  // namespace marti::studies
