#include "scenes/file_access.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/files.h"
#include "sim/input_files.h"

namespace marti::scenes {

namespace {

// RFC 3986, section 3.1: "file:" and the like.
bool has_scheme(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string_view::npos && colon > 1 &&
         std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '.';
         });
}

bool lies_in(const std::filesystem::path& file, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

}  // namespace

std::string double_quoted(std::string_view text) {
  constexpr std::size_t longest = 200;
  const bool cut = text.size() > longest;
  return nlohmann::json(text.substr(0, longest))
             .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) +
         (cut ? "..." : "");
}

FileAccess::FileAccess(const std::filesystem::path& directory, std::uint64_t max_bytes,
                       sim::MemoryBudget& memory, const char* kind)
    : directory_(directory.empty() ? "./" : directory.string()),
      max_bytes_(max_bytes),
      memory_(memory),
      kind_(kind) {
  if (!directory_.ends_with('/')) {
    directory_ += '/';
  }
  std::error_code error;
  root_ = std::filesystem::canonical(directory_, error);
}

bool FileAccess::may_read(const std::string& name) {
  // Some callers also look in the current directory; the result must not depend on it.
  if (!refusal_.empty() || !name.starts_with(directory_) || name.find('\0') != std::string::npos) {
    return false;
  }
  const std::string_view uri = std::string_view(name).substr(directory_.size());
  std::error_code error;
  const std::filesystem::path file = std::filesystem::weakly_canonical(name, error);
  if (uri.starts_with('/') || has_scheme(uri) || error || !lies_in(file, root_)) {
    refusal_ = "the " + std::string(kind_) + " " + double_quoted(uri) +
               " leads out of the scene's folder; only files in it can be read";
    return false;
  }
  return std::filesystem::is_regular_file(file, error);
}

bool FileAccess::read(const std::string& name, std::string& bytes, std::string& error) {
  try {
    std::error_code failed;
    // The checked location, with links resolved.
    const std::filesystem::path file = std::filesystem::weakly_canonical(name);
    const std::uintmax_t size = std::filesystem::file_size(file, failed);
    if (!failed && size <= max_bytes_) {
      try {
        memory_.require(2 * size, "the file " + double_quoted(name) + " takes", "");  // it is copied once
        memory_.take(size, "the file " + double_quoted(name) + " takes", "");
      } catch (const sim::UserError& reason) {
        refusal_ = reason.what();
        return false;
      }
    }
    bytes = sim::read_file(file, static_cast<std::int64_t>(max_bytes_));
    sim::note_input(file);
    return true;
  } catch (const std::exception& reason) {
    error += reason.what();
    return false;
  }
}

}  // namespace marti::scenes
