// The report of a run's directory: what its result.json says, and the files beside it.
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/files.h"
#include "studies/report/report_files.h"
#include "studies/report/report_kinds.h"
#include "studies/report/run_answer.h"
#include "studies/report/run_charts.h"
#include "studies/results/run_json.h"

namespace marti::studies {

namespace {

namespace fs = std::filesystem;

void add_configuration(const RunJson& run, ReportData& report) {
  std::string defaults;
  for (const auto& [key, setting] : run.at("config.keys").items()) {
    const RunJson each(setting, run.file());
    const std::string line = key + " = " + each.text("value") + "\n";
    (each.boolean("given") ? report.configuration : defaults) += line;
  }
  report.configuration =
      "# given in the file or by --set\n" + report.configuration + "\n# defaults\n" + defaults;
}

Table plan_table(const RunJson& run) {
  Table table("plan", "The plan: what the run left out",
              {{"item", ColumnType::text, "", "what could be left out"},
               {"decision", ColumnType::text, "", "left out, needed, kept or no matter"},
               {"class", ColumnType::text, "", "proved before the frame, or decided ray by ray"},
               {"fact", ColumnType::text, "", "what the decision rests on"},
               {"saved_operations", ColumnType::integer, "1", "counted after the frame"},
               {"unit", ColumnType::text, "", "of saved_operations"}});
  for (const auto& [name, item] : run.at("plan").items()) {
    const RunJson each(item, run.file());
    const bool saved = each.find("counted.operations").is_number_integer();
    table.add_row({name, each.text("decision"), each.text("class"), each.text("fact"),
                   saved ? Cell(whole(each, "counted.operations")) : Cell(), each.text("unit")});
  }
  return table;
}

Table figures_table(const RunJson& run) {
  Table table(
      "figures", "Figures of the run",
      {{"figure", ColumnType::text, "", "field of result.json"}, {"value", ColumnType::text, "", ""}});
  for (const char* part : {"scene", "structure", "image", "work_log", "machine"}) {
    for (const auto& [name, value] : run.at(part).items()) {
      if (value.is_number() || value.is_boolean() || value.is_string()) {
        table.add_row(
            {fmt::format("{}.{}", part, name), value.is_string() ? value.get<std::string>() : value.dump()});
      }
    }
  }
  return table;
}

void add_images(const fs::path& directory, ReportData& report) {
  constexpr std::pair<const char*, const char*> images[] = {
      {"image.png", "The image"},
      {"exact.png", "The exact image, without the voxel cut"},
      {"heat-cycles.png", "Heat map: cycles of each pixel"},
      {"heat-misses.png", "Heat map: misses of each pixel"},
      {"heat-waits.png", "Heat map: waits of each pixel"}};
  for (const auto& [name, title] : images) {
    if (is_there(directory / name)) {
      take_image(directory / name, title, report);
    }
  }
}

}  // namespace

ReportData read_run_report(const fs::path& directory) {
  const RunJson run = read_run_json(directory / "result.json", {"config.keys", "scene", "structure", "image",
                                                                "work_log", "plan", "machine"});
  ReportData report;
  report.kind = "run";
  report.title = fmt::format("Run of {} on {}", run.text("scene.name"), machine_text(run));
  report.answer = answer_of(run);
  add_run_charts(run, report);
  if (is_there(directory / "working_set.vl.json")) {
    ReportChart chart = read_chart(directory / "working_set.vl.json");
    chart.name = "working_set";
    report.charts.push_back(std::move(chart));
  }
  add_images(directory, report);
  report.tables.push_back({plan_table(run), true});
  report.tables.push_back({figures_table(run), true});
  add_configuration(run, report);
  report.provenance = {{"version of marti", run.text("marti.version")},
                       {"configuration", run.text("config.file")},
                       {"scene", run.text("scene.source")},
                       {"hash of the image", run.text("image.image_hash")},
                       {"hash of all hits", run.text("image.hit_hash")}};
  return report;
}

}  // namespace marti::studies
