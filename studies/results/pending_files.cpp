#include "studies/results/pending_files.h"

#include <utility>

namespace marti::studies {

PendingFiles::PendingFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}

const std::filesystem::path& PendingFiles::add(const std::string& name) {
  names_.push_back(directory_ / name);
  return pending_.emplace_back(names_.back()).temporary();
}

void PendingFiles::write(const std::string& name, std::string_view content) {
  sim::write_file(add(name), content);
}

std::vector<std::filesystem::path> PendingFiles::commit() {
  for (sim::PendingFile& file : pending_) {
    file.commit();
  }
  return names_;
}

}  // namespace marti::studies
