#include "studies/output.h"

#include <csignal>
#include <optional>

#include "sim/files.h"
#include "studies/image_file.h"

namespace marti::studies {

namespace {

// While it lives, SIGINT and SIGTERM wait.
class SignalsHeld {
 public:
  SignalsHeld() {
    sigset_t held;
    sigemptyset(&held);
    sigaddset(&held, SIGINT);
    sigaddset(&held, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &held, &before_);
  }
  ~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

void prepare_output(const std::filesystem::path& directory) {
  sim::make_directory(directory);
  sim::PendingFile probe(directory / "probe");
  sim::write_file(probe.temporary(), "");
}

std::vector<std::filesystem::path> write_output(const RunResult& result,
                                                const std::filesystem::path& directory) {
  const SignalsHeld held;
  sim::PendingFile exr(directory / "image.exr");
  sim::PendingFile png(directory / "image.png");
  sim::PendingFile json(directory / "result.json");
  write_exr(result.functional.frame.image, exr.temporary());
  write_png(result.functional.frame.image, png.temporary());
  sim::write_file(json.temporary(), json_of(result));
  std::vector<std::filesystem::path> files = {directory / "image.exr", directory / "image.png",
                                              directory / "result.json"};
  std::optional<sim::PendingFile> exact_exr;
  std::optional<sim::PendingFile> exact_png;
  if (result.functional.voxel_cut && result.functional.voxel_cut->exact) {
    const processors::Image& exact = result.functional.voxel_cut->exact->image;
    files.insert(files.end(), {directory / "exact.exr", directory / "exact.png"});
    write_exr(exact, exact_exr.emplace(directory / "exact.exr").temporary());
    write_png(exact, exact_png.emplace(directory / "exact.png").temporary());
    exact_exr->commit();
    exact_png->commit();
  }
  exr.commit();
  png.commit();
  json.commit();
  return files;
}

}  // namespace marti::studies
