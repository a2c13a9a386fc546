#include "studies/tables/file_set.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "sim/error.h"
#include "sim/files.h"
#include "sim/sha256.h"

namespace marti::studies::tables {

namespace fs = std::filesystem;

namespace {

constexpr auto utf8_only = nlohmann::ordered_json::error_handler_t::replace;

}  // namespace

FileSet read_file_set(const fs::path& file) {
  constexpr std::int64_t most_bytes = std::int64_t{64} << 20U;
  nlohmann::ordered_json json;
  try {
    // Anybody may have written the file: what is nested deeper than ours is dropped.
    const auto shallow = [](int depth, auto /*event*/, auto& /*value*/) { return depth <= 4; };
    json = nlohmann::ordered_json::parse(sim::read_file(file, most_bytes), shallow, false);
  } catch (const sim::UserError&) {
    return {};
  }
  if (!json.is_object() || !json.contains("files") || !json["files"].is_object()) {
    return {};
  }
  const auto taken = [&json](const char* member) {
    std::map<std::string, std::string> by_name;
    const nlohmann::ordered_json texts = json.value(member, nlohmann::ordered_json::object());
    json.erase(member);
    for (const auto& [name, text] : texts.items()) {
      if (text.is_string() && !name.empty() && fs::path(name).filename() == name) {
        by_name[name] = text.get<std::string>();
      }
    }
    return by_name;
  };
  FileSet set{{}, taken("files"), taken("notes")};
  set.of = json.dump(-1, ' ', false, utf8_only);
  return set;
}

std::string text_of(const FileSet& set) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(set.of);
  if (!set.notes.empty()) {
    json["notes"] = set.notes;
  }
  json["files"] = set.files;
  return json.dump(2, ' ', false, utf8_only) + "\n";
}

bool is_as_written(const FileSet& set, const fs::path& directory, const std::string& name) {
  const auto found = set.files.find(name);
  try {
    return found != set.files.end() && sim::sha256_of_file(directory / name) == found->second;
  } catch (const sim::UserError&) {
    return false;  // missing, or not a regular file
  }
}

void remove_others(const FileSet& earlier, const FileSet& now, const fs::path& directory) {
  for (const auto& [name, hash] : earlier.files) {
    if (!now.files.contains(name) && is_as_written(earlier, directory, name)) {
      std::error_code stays;
      fs::remove(directory / name, stays);
    }
  }
}

}  // namespace marti::studies::tables
