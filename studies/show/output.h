// Writing a run's files: all or, as far as a file system allows, none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/made_directory.h"
#include "studies/run/run_result.h"

namespace marti::studies::show {

/// Makes sure that `directory` exists and can be written to, so that a long run does not end in a refusal. To
/// be kept until the files are written: what was made and is empty then is removed. An empty name makes
/// nothing.
[[nodiscard]] sim::MadeDirectory prepare_output(const std::filesystem::path& directory);

/// prepare_output() for the files of a run: refuses a directory with another kind of result, and begins to
/// load what writes images.
[[nodiscard]] sim::MadeDirectory prepare_run(const std::filesystem::path& directory);

struct WrittenRun {
  std::vector<std::filesystem::path> files;
  std::string json;  ///< of the result, as result.json has it
};

/// Writes image.exr, image.png and result.json, and exact.exr and exact.png of a run with
/// image.voxel_cut_reference, and what the run has recorded, under temporary names and renames them together
/// at the end; then removes the files of an earlier run that this one lacks. Signals that end the program
/// wait until that is done. Throws UserError with the reason; older results are unchanged then, unless
/// the system refuses to rename a file after it has renamed others.
WrittenRun write_output(const run::RunResult& result, const std::filesystem::path& directory);

}  // namespace marti::studies::show
