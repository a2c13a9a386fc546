// Configurations as a command names them: a file, or "-" for standard input.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "sim/config.h"

namespace marti::studies::keys {

struct ConfigText {
  std::string text;
  std::string name;  ///< for messages; files that the configuration names are relative to its directory
};

/// At most sim::longest_config bytes. Throws UserError when `file` cannot be read, and when it does not exist
/// or is a directory: with the name that was probably meant, if one is near (in the same directory, or the
/// same name in a directory above the current one), and the current directory.
[[nodiscard]] ConfigText read_config_text(const std::filesystem::path& file);

/// The configuration of a file, as sim::Config::from_file() reads it, or of standard input.
[[nodiscard]] sim::Config read_config(const sim::Schema& schema, const std::filesystem::path& file,
                                      std::span<const std::string> assignments = {});

/// read_config(); without a name all keys have their defaults.
[[nodiscard]] sim::Config read_config_or_defaults(const sim::Schema& schema,
                                                  const std::filesystem::path& file,
                                                  std::span<const std::string> assignments = {});

}  // namespace marti::studies::keys
