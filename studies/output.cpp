#include "studies/output.h"

#include <optional>

#include "sim/files.h"
#include "studies/count_output.h"
#include "studies/image_file.h"
#include "studies/record/heat_files.h"
#include "studies/results/csv.h"
#include "studies/signals_held.h"
#include "studies/working_set_output.h"

namespace marti::studies {

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
  std::optional<HeatFiles> heat;
  if (result.heat_map) {
    heat.emplace(*result.heat_map, directory);
    heat->commit();
    files.insert(files.end(), heat->files().begin(), heat->files().end());
  }
  std::optional<sim::PendingFile> attribution;
  if (result.timed.counts.attribution) {
    sim::write_file(attribution.emplace(directory / "attribution.csv").temporary(),
                    csv_of(attribution_table(*result.timed.counts.attribution)));
    attribution->commit();
    files.push_back(directory / "attribution.csv");
  }
  std::optional<sim::PendingFile> working_set;
  std::optional<sim::PendingFile> curve;
  if (result.working_set) {
    const Table table = working_set_table(*result.working_set);
    sim::write_file(working_set.emplace(directory / "working_set.csv").temporary(), csv_of(table));
    sim::write_file(curve.emplace(directory / "working_set.vl.json").temporary(), working_set_chart(table));
    working_set->commit();
    curve->commit();
    files.insert(files.end(), {directory / "working_set.csv", directory / "working_set.vl.json"});
  }
  if (result.timeline) {
    result.timeline->commit();
    files.push_back(directory / "timeline.json");
  }
  exr.commit();
  png.commit();
  json.commit();
  return files;
}

}  // namespace marti::studies
