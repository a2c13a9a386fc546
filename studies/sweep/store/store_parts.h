// The parts of a store: files beside it in which several processes have each timed a share of the machines.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace marti::studies::sweep {

/// The file of that share (from 1) in a sweep's directory: "results.3-of-8.sqlite".
[[nodiscard]] std::filesystem::path part_file(const std::filesystem::path& directory, std::uint32_t number,
                                              std::uint32_t of);

/// All parts that the directory holds, sorted by name.
[[nodiscard]] std::vector<std::filesystem::path> parts_in(const std::filesystem::path& directory);

/// The keys of all machines and frames whose results are in a store or part; none when the file is missing or
/// was never written. Throws UserError when its results may not be merged with those of this program: when it
/// is damaged, or of another format, version or build.
struct DoneKeys {
  std::set<std::string> machines;
  std::set<std::string> frames;

  void add(const std::filesystem::path& store);
};

/// What the store in the directory and its parts have between them, but for parts that are being written.
/// Nothing for an empty name.
[[nodiscard]] DoneKeys done_in(const std::filesystem::path& directory);

}  // namespace marti::studies::sweep
