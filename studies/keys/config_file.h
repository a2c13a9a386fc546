// The error message for a configuration file that does not exist.
#pragma once

#include <filesystem>

namespace marti::studies::keys {

/// Throws UserError when `file` does not exist or is a directory: with the name that was probably meant, if
/// one is near (in the same directory, or the same name in a directory above the current one), and the
/// current directory.
void require_config_file(const std::filesystem::path& file);

}  // namespace marti::studies::keys
