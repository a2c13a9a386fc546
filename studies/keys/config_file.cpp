#include "studies/keys/config_file.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "sim/error.h"
#include "sim/files.h"
#include "sim/input_files.h"
#include "sim/nearest.h"
#include "sim/units.h"

namespace marti::studies::keys {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view standard_input = "standard input";

// The names of the directories, or of the other files, in `directory`; sorted, empty if it cannot be read.
std::vector<std::string> names_in(const fs::path& directory, bool directories) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(directory.empty() ? "." : directory, error), end; !error && at != end;
       at.increment(error)) {
    std::error_code ignored;
    if (directories ? at->is_directory(ignored) : at->path().extension() == ".toml") {
      names.push_back(at->path().filename().string());
    }
  }
  std::ranges::sort(names);
  return names;
}

// The file that was probably meant, or an empty path.
fs::path nearest_file(const fs::path& file) {
  std::error_code error;
  const fs::path parent = file.parent_path();
  if (!parent.empty() && !fs::is_directory(parent, error)) {
    const std::vector<std::string> names = names_in(parent.parent_path(), true);
    const fs::path near = parent.parent_path() / sim::nearest_name(parent.filename().string(), names);
    if (fs::is_regular_file(near / file.filename(), error)) {
      return near / file.filename();
    }
  }
  // The program may run below the directory that the name is relative to, or the name may lack its directory.
  if (file.is_relative()) {
    for (const fs::path above : {"configs", "..", "../..", "../configs", "../../.."}) {
      if (fs::is_regular_file(above / file, error)) {
        return above / file;
      }
    }
  }
  const std::vector<std::string> names = names_in(parent, false);
  const std::string_view near = sim::nearest_name(file.filename().string(), names);
  return near.empty() ? fs::path() : parent / near;
}

void require_file(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) {
    const std::vector<std::string> names = names_in(file, false);
    throw sim::UserError(
        sim::Place{file.string(), file.string()},
        "is a directory; name a configuration" +
            (names.empty() ? " (a .toml file)" : " in it, such as " + (file / names.front()).string()));
  }
  if (fs::exists(file, error) || (error && error != std::errc::not_a_directory)) {
    return;
  }
  const fs::path near = nearest_file(file);
  throw sim::UserError(
      sim::Place{file.string(), file.string()},
      "there is no such file" + (near.empty() ? "" : " (did you mean \"" + near.string() + "\"?)") +
          (file.is_relative() ? "; the current directory is " + fs::current_path(error).string() : ""));
}

std::string read_standard_input() {
  std::string text;
  std::array<char, 65536> part{};
  while (text.size() <= static_cast<std::size_t>(sim::longest_config)) {
    const std::size_t read = std::fread(part.data(), 1, part.size(), stdin);
    text.append(part.data(), read);
    if (read < part.size()) {
      break;
    }
  }
  if (std::ferror(stdin) != 0) {
    throw sim::UserError(std::string(standard_input) + ": cannot be read");
  }
  if (text.size() > static_cast<std::size_t>(sim::longest_config)) {
    throw sim::UserError(std::string(standard_input) + ": is longer than " +
                         sim::print_size(sim::longest_config));
  }
  return text;
}

}  // namespace

ConfigText read_config_text(const fs::path& file) {
  if (file == "-") {
    return {read_standard_input(), std::string(standard_input)};
  }
  require_file(file);
  ConfigText config{sim::read_file(file, sim::longest_config), file.string()};
  sim::note_input(file);
  return config;
}

sim::Config read_config(const sim::Schema& schema, const fs::path& file,
                        std::span<const std::string> assignments) {
  const ConfigText config = read_config_text(file);
  return sim::Config::from_text(schema, config.text, config.name, assignments);
}

sim::Config read_config_or_defaults(const sim::Schema& schema, const std::filesystem::path& file,
                                    std::span<const std::string> assignments) {
  return file.empty() ? sim::Config::from_text(schema, "", "defaults", assignments)
                      : read_config(schema, file, assignments);
}

}  // namespace marti::studies::keys
