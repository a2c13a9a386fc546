#include "studies/show/output.h"

#include <fcntl.h>

#include <map>

#include "sim/descriptor.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/pending_file.h"
#include "sim/sha256.h"
#include "studies/host/image_file.h"
#include "studies/host/signals_held.h"
#include "studies/run/record/heat_files.h"
#include "studies/show/hits_file.h"
#include "studies/show/result_json.h"
#include "studies/show/result_parts.h"
#include "studies/tables/chart.h"
#include "studies/tables/csv.h"
#include "studies/tables/page_file.h"
#include "studies/tables/pending_files.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/run_files.h"

namespace marti::studies::show {

namespace {

constexpr const char* timeline_name = "timeline.json";

void add_image(const processors::program::Image& image, const std::string& name,
               tables::PendingFiles& files) {
  files.write(name + ".exr", host::exr_file(image));
  files.write(name + ".png", host::png_file(image));
}

void add_files(const run::RunResult& result, tables::PendingFiles& files) {
  if (result.frame_config.log == nullptr) {
    add_image(result.functional.frame.image, "image", files);
  }
  if (!result.functional.frame.hits.empty()) {
    files.write("hits.npy", hits_file(result.functional.frame, result.functional.totals.all_rays()));
  }
  if (result.functional.voxel_cut && result.functional.voxel_cut->exact) {
    add_image(result.functional.voxel_cut->exact->image, "exact", files);
  }
  if (result.heat_map) {
    run::add_heat_files(*result.heat_map, files);
  }
  if (result.timed.counts.attribution) {
    files.write("attribution.csv", tables::csv_of(attribution_table(*result.timed.counts.attribution)));
  }
  if (result.intervals) {
    files.write("intervals.csv", tables::csv_of(*result.intervals));
  }
  if (result.working_set) {
    const tables::Table table = working_set_table(*result.working_set);
    files.write("working_set.csv", tables::csv_of(table));
    files.write("working_set.vl.json",
                tables::fill_chart(tables::chart_named(tables::chart_specifications(), table.name()), table));
  }
}

// Whether an earlier run has written this result: then a page that was made of it still tells the truth.
bool is_result(const std::filesystem::path& file, const std::string& json) {
  try {
    return sim::read_file(file, static_cast<std::int64_t>(json.size())) == json;
  } catch (const sim::UserError&) {
    return false;  // no file that can be read, or one longer than `json`
  }
}

}  // namespace

sim::MadeDirectory prepare_output(const std::filesystem::path& directory) {
  if (directory.empty()) {
    return {};
  }
  sim::MadeDirectory made(directory);
  // A file without a name, because whatever ends the program here, none must stay.
  const sim::Descriptor nameless(::open(directory.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
  if (nameless.get() < 0) {
    // The file system has none, or no file can be written, which this says.
    const sim::PendingFile probe(directory / "probe");
  }
  return made;
}

sim::MadeDirectory prepare_run(const std::filesystem::path& directory) {
  tables::refuse_other_results(directory, tables::run_name);
  sim::MadeDirectory made = prepare_output(directory);
  if (!directory.empty()) {
    host::begin_to_load_image_library();
  }
  return made;
}

WrittenRun write_output(const run::RunResult& result, const std::filesystem::path& directory) {
  const host::SignalsHeld held;
  const std::map<std::string, std::string> earlier = tables::files_of_run_in(directory);
  tables::PendingFiles files(directory);
  add_files(result, files);
  std::map<std::string, std::string> hashes = files.hashes();
  if (result.timeline) {
    hashes[timeline_name] = sim::sha256_of_file(result.timeline->temporary());
  }
  WrittenRun written{{}, json_of(result, hashes)};
  const bool same = is_result(directory / tables::run_name, written.json);
  files.write(tables::run_name, written.json);
  if (result.timeline) {
    result.timeline->commit();
  }
  written.files = files.commit();
  if (result.timeline) {
    written.files.push_back(directory / timeline_name);
  }
  if (!same) {
    tables::remove_sealed_page(directory / tables::report_page_name);
  }
  for (const auto& [name, hash] : earlier) {
    if (!hashes.contains(name)) {
      tables::remove_run_file(directory / name, hash);
    }
  }
  return written;
}

}  // namespace marti::studies::show
