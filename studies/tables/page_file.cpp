#include "studies/tables/page_file.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include "sim/error.h"
#include "sim/files.h"
#include "sim/sha256.h"
#include "studies/host/signals_held.h"
#include "studies/tables/pending_files.h"

namespace marti::studies::tables {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view seal_begin = "<!-- marti: SHA-256 of all above this line ";
constexpr std::string_view seal_end = " -->\n";
constexpr std::size_t hash_digits = 64;

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

std::string sealed(std::string html) {
  const std::string hash = sim::sha256_text(html);
  return std::move(html) + std::string(seal_begin) + hash + std::string(seal_end);
}

void remove_sealed_page(const fs::path& file) {
  constexpr std::int64_t most_bytes = std::int64_t{256} << 20U;
  constexpr std::size_t length = seal_begin.size() + hash_digits + seal_end.size();
  std::error_code error;
  if (fs::symlink_status(file, error).type() != fs::file_type::regular) {
    return;
  }
  try {
    const std::string text = sim::read_file(file, most_bytes);
    if (text.size() >= length && sealed(text.substr(0, text.size() - length)) == text) {
      fs::remove(file, error);  // what cannot be removed stays
    }
  } catch (const sim::UserError&) {
    // It cannot be read, or is longer than a page.
  }
}

void write_page(const fs::path& file, std::string_view html) {
  const host::SignalsHeld held;
  PendingFiles pending(directory_of(file));
  pending.write(file.filename().string(), html);
  (void)pending.commit();
}

}  // namespace marti::studies::tables
