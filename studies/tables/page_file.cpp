#include "studies/tables/page_file.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <system_error>

#include "sim/error.h"
#include "studies/host/signals_held.h"
#include "studies/tables/pending_files.h"

namespace marti::studies::tables {

namespace fs = std::filesystem;

namespace {

bool is_page(const fs::path& file) {
  constexpr std::string_view begin = "<!doctype html";
  std::string text(begin.size(), '\0');
  std::ifstream(file, std::ios::binary).read(text.data(), static_cast<std::streamsize>(text.size()));
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text == begin;
}

}  // namespace

fs::path directory_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

void check_page_target(const fs::path& file) {
  std::error_code error;
  if (!fs::is_directory(directory_of(file), error)) {
    throw sim::UserError(file.string() + ": cannot be written: " + directory_of(file).string() +
                         (error ? ": " + error.message() : " is no directory"));
  }
  if (fs::symlink_status(file, error).type() == fs::file_type::not_found) {
    return;
  }
  if (!fs::is_regular_file(file, error)) {
    const bool unknown = error && error != std::errc::no_such_file_or_directory;  // a link to nothing
    throw sim::UserError(file.string() +
                         (unknown ? ": cannot be written: " + error.message()
                                  : ": is no regular file; choose another name for the page with -o"));
  }
  if (!is_page(file)) {
    throw sim::UserError(
        file.string() +
        ": exists and is not an HTML page, so it is not replaced by a page; choose another name with -o, "
        "or remove it");
  }
}

void write_page(const fs::path& file, std::string_view html) {
  const host::SignalsHeld held;
  PendingFiles pending(directory_of(file));
  pending.write(file.filename().string(), html);
  (void)pending.commit();
}

}  // namespace marti::studies::tables
