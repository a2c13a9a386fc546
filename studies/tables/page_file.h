// The file of an HTML page. A page may replace an older page, but no results and nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace marti::studies::tables {

/// The directory that the file is in; "." for a name alone.
[[nodiscard]] std::filesystem::path directory_of(const std::filesystem::path& file);

/// Throws UserError, with the reason, unless a page of this name can be written: its directory must be there,
/// and what has the name already must be an HTML page. To be called before anything is worked out.
void check_page_target(const std::filesystem::path& file);

/// The page with a last line that has the hash of all above it, by which it is known again.
[[nodiscard]] std::string sealed(std::string html);

/// Removes a file that is a sealed page and has not been changed since; anything else stays.
void remove_sealed_page(const std::filesystem::path& file);

/// Writes the page under a temporary name and renames it. UserError if that fails; then a page that was there
/// is as it was.
void write_page(const std::filesystem::path& file, std::string_view html);

}  // namespace marti::studies::tables
