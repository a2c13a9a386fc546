// The report of a run's directory: what its result.json says, and the files beside it; and that of a point of
// a sweep, from the figures and settings that its store keeps.
#include <fmt/format.h>

#include <map>

#include "sim/error.h"
#include "sim/sha256.h"
#include "studies/keys/setting_value.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/model/run_answer.h"
#include "studies/report/read/read_report.h"
#include "studies/report/read/report_files.h"
#include "studies/sweep/store/point_result.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/run_files.h"
#include "studies/tables/run_json.h"

namespace marti::studies::report {

namespace {

namespace fs = std::filesystem;

void add_configuration(const tables::RunJson& run, ReportData& report) {
  const std::map<std::string, std::string> settings = keys::settings_of(run);
  std::string defaults;
  for (const auto& [key, setting] : run.at("config.keys").items()) {
    (run.of(setting).boolean("given") ? report.configuration : defaults) +=
        key + " = " + settings.at(key) + "\n";
  }
  report.configuration =
      "# given in the file or by --set\n" + report.configuration + "\n# defaults\n" + defaults;
}

// Whether the run has written what now stands under that name; otherwise the page says why it is left out.
bool is_of_run(const fs::path& directory, const std::string& name,
               const std::map<std::string, std::string>& files, ReportData& report) {
  const auto named = files.find(name);
  if (!tables::is_there(directory / name)) {
    if (named == files.end()) {
      return false;
    }
    report.answer.push_back(name + " is left out of this page: it is not there any more.");
    return false;
  }
  std::string reason = "result.json does not name it";
  if (named != files.end()) {
    try {
      if (sim::sha256_of_file(directory / name) == named->second) {
        return true;
      }
      reason = "it is not the file that this run has written";
    } catch (const sim::UserError&) {
      reason = "it cannot be read, or is no regular file";
    }
  }
  report.answer.push_back(name + " is left out of this page: " + reason + ".");
  return false;
}

// What the brightest colour of a heat map stands for; empty for other images, and where the run does not say.
std::string scale_text(const tables::RunJson& run, const char* heat, const char* unit, const char* plural) {
  if (heat == nullptr) {
    return {};
  }
  const std::optional<double> brightest = run.number(fmt::format("heat_maps.{}.brightest", heat));
  return brightest ? fmt::format("{:g} {}{} or more", *brightest, unit, *brightest == 1.0 ? "" : plural)
                   : std::string();
}

// "image scheme, nodes at 100 MHz, caches of 16 KiB, bus": what tells a machine from others, as far as the
// result says it.
std::string about_machine(const tables::RunJson& run) {
  const std::map<std::string, std::string> settings = keys::settings_of(run);
  const auto setting = [&settings](const char* key) {
    const auto at = settings.find(key);
    return at == settings.end() ? std::string() : keys::plain_setting(at->second);
  };
  std::string text;
  const auto add = [&](const std::string& value, const std::string& before, const std::string& after = {}) {
    if (!value.empty()) {
      text += (text.empty() ? "" : ", ") + before + value + after;
    }
  };
  add(setting("machine.scheme"), "", " scheme");
  add(setting("node.clock"), "nodes at ");
  if (const std::string caches = setting("cache.organisation"); caches == "none") {
    add("no caches", "");
  } else {
    add(setting("cache.size"), "caches of ");
  }
  add(setting("interconnect.kind"), "");
  add(keys::pixels_of(settings), "");
  return text;
}

void add_files(const fs::path& directory, const tables::RunJson& run, ReportData& report) {
  const std::map<std::string, std::string> files = tables::files_of(run);
  if (const char* chart = "working_set.vl.json"; is_of_run(directory, chart, files, report)) {
    // Only its rows: how they are drawn is built into the program.
    report.charts.push_back(
        chart_of_results(tables::chart_named(tables::chart_specifications(), "working_set"),
                         read_chart_rows(directory / chart)));
  }
  struct Image {
    const char* name;
    const char* title;
    const char* heat = nullptr;  // of a heat map
    const char* unit = nullptr;
    const char* plural = nullptr;  // what the unit's plural has more
  };
  const bool rays = keys::settings_of(run).contains("image.rays");
  const Image images[] = {
      {"image.png", rays ? "What the rays hit, row by row: lighter is nearer" : "The image"},
      {"exact.png", "The exact image, without the voxel cut"},
      {"heat-cycles.png", "Heat map: cycles of each pixel", "cycles", "cycle", "s"},
      {"heat-misses.png", "Heat map: misses of each pixel", "misses", "miss", "es"},
      {"heat-waits.png", "Heat map: waits of each pixel", "waits", "cycle", "s"}};
  for (const Image& image : images) {
    if (is_of_run(directory, image.name, files, report)) {
      take_image(directory / image.name, image.title, report,
                 scale_text(run, image.heat, image.unit, image.plural));
    }
  }
}

// What a run and a point of a sweep have both.
ReportData machine_report(const tables::RunJson& run, const std::string& base) {
  ReportData report;
  report.kind = "run";
  report.about = about_machine(run);
  report.answer = answer_of(run, base);
  add_queried(run, report);
  add_configuration(run, report);
  report.provenance = {{"version of marti", run.text("marti.version")},
                       {"configuration", run.text("config.file")},
                       {"hash of the image", run.text("figures.frame.image_hash")},
                       {"hash of all hits", run.text("figures.frame.hit_hash")}};
  return report;
}

}  // namespace

ReportData read_run_report(const fs::path& directory) {
  const tables::RunJson run = tables::read_run_json(
      directory / "result.json",
      {"config.keys", "figures.frame", "figures.machine", "scene", "structure", "plan", "machine"});
  ReportData report = report_of_run(run);
  add_files(directory, run, report);
  return report;
}

ReportData report_of_run(const tables::RunJson& run) {
  ReportData report = machine_report(run, "one node");
  report.title = fmt::format("Run of {} on {}", run.text("figures.frame.scene"), machine_text(run));
  report.provenance.emplace_back("scene", run.text("scene.source"));
  return report;
}

ReportData read_point_report(const tables::PointName& point) {
  const tables::RunJson run = sweep::point_result(sweep::SweepReader(point.store), point.ordinal, point.name);
  ReportData report = machine_report(run, "its base machine");
  report.title = fmt::format("Point {} of a sweep: {} on {}", point.ordinal, run.text("figures.frame.scene"),
                             machine_text(run));
  return report;
}

}  // namespace marti::studies::report
