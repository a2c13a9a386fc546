#include "studies/error/error.h"

#include <fmt/format.h>

#include "sim/joined.h"
#include "studies/error/error_keys.h"
#include "studies/error/error_tables.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::error {

tables::StudyOutput run_error(sim::Config& config, sim::WorkMeter* meter) {
  const ErrorConfig error = read_error(config);
  std::vector<Setting> settings;
  add_frame_ways(error, settings);
  add_image_knobs(error, settings);
  measure(settings, error.repeats, meter);

  tables::StudyOutput output;
  const processors::program::RenderOptions& render = error.frame.render;
  const processors::program::RenderOptions small = keys::made_small(render, error.side);
  output.report = fmt::format(
      "Error against run time of {}\nframe time: {}, {} a pixel, {}\nimage: {}, at most {} in a "
      "row, {} a pixel; each knob is held against its own exact setting\n",
      error.frame.scene, keys::size_text(render), tables::counted(render.samples, "sample"),
      tables::counted(error.machine.all_nodes(), "node"), keys::size_text(small),
      tables::counted(small.max_depth, "ray"), tables::counted(small.samples, "sample"));
  const std::vector<std::string> answers = answers_of(settings);
  output.host_tables = {
      error_table(settings),
      tables::answer_table("host_error_answer", "Which way gives which error for which share of the run time",
                           answers)};
  output.host_report = sim::joined(answers, "\n") + "\n\n" + tables::text_of(output.host_tables[0]);
  output.tables.push_back(tables::provenance_table(config.effective_values()));
  output.host_tables.push_back(tables::host_table());
  return output;
}

}  // namespace marti::studies::error
