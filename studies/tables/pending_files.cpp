#include "studies/tables/pending_files.h"

#include <utility>

#include "sim/input_files.h"
#include "sim/sha256.h"
#include "studies/tables/file_set.h"

namespace marti::studies::tables {

PendingFiles::PendingFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}

const std::filesystem::path& PendingFiles::add(const std::string& name) {
  names_.push_back(directory_ / name);
  sim::refuse_input(names_.back());
  return pending_.emplace_back(names_.back()).temporary();
}

void PendingFiles::write(const std::string& name, std::string_view content) {
  (void)add(name);
  pending_.back().write(content);
}

std::map<std::string, std::string> PendingFiles::hashes() const {
  std::map<std::string, std::string> hashes;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    hashes[names_[i].filename().string()] = sim::sha256_of_file(pending_[i].temporary());
  }
  return hashes;
}

std::vector<std::filesystem::path> PendingFiles::commit_set() {
  constexpr const char* name = "files.json";
  const FileSet earlier = read_file_set(directory_ / name);
  const FileSet now{.files = hashes()};
  write(name, text_of(now));
  std::vector<std::filesystem::path> written = commit();
  remove_others(earlier, now, directory_);
  return written;
}

std::vector<std::filesystem::path> PendingFiles::commit() {
  for (sim::PendingFile& file : pending_) {
    file.commit();
  }
  return names_;
}

}  // namespace marti::studies::tables
