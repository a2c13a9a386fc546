#include "studies/schemes/schemes.h"

#include <fmt/format.h>

#include <string>

#include "studies/run/functional_run.h"
#include "studies/schemes/arguments.h"
#include "studies/schemes/scaling_table.h"
#include "studies/schemes/schemes_keys.h"
#include "studies/schemes/tree_tables.h"
#include "studies/tables/claim.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"

namespace marti::studies::schemes {

tables::StudyOutput run_schemes(sim::Config& config, sim::WorkMeter* meter) {
  SchemesConfig schemes = read_schemes(config);
  schemes.frame.wait_with(meter);
  const run::FunctionalRun run = run::run_functional(schemes.frame);
  const processors::program::WorkLog& log = *run.frame.log;
  sim::plan_parts(meter, "stages", schemes.stage_machine.empty() ? 0 : 1);
  sim::plan_parts(meter, "machines", machines_to_time(schemes));
  sim::plan_parts(meter, "trees", schemes.cell_levels.size() + schemes.structures.size());
  const std::vector<StagePoint> stages = time_stages(schemes, log);
  const std::vector<ScalingPoint> points = time_machines(schemes, log, stages);
  const std::vector<CellPoint> cells = time_cells(schemes);
  const std::vector<tables::Claim> claims = check_arguments(points, cells, stages);

  tables::StudyOutput output;
  output.tables = {scaling_table(points), stage_table(stages), cell_table(cells),
                   tables::claim_table(claims)};
  output.report =
      fmt::format("Parallel schemes on {}, {}, {} rays\n\n", schemes.frame.scene,
                  keys::size_text(schemes.frame.render), run.totals.all_rays()) +
      tables::side_by_side(output.tables[0], "nodes", "machine", "speed_up", "Speed-up over one node") +
      "\n" + tables::side_by_side(output.tables[0], "nodes", "machine", "efficiency", "Efficiency") + "\n" +
      tables::text_of(output.tables[1]) + "\n" + tables::text_of(output.tables[2]) + "\n" +
      tables::text_of(claims);
  if (!schemes.structures.empty()) {
    output.tables.push_back(structure_table(time_structures(schemes)));
    output.report += "\n" + tables::text_of(output.tables.back());
  }
  output.tables.push_back(tables::provenance_table(config.effective_values()));
  return output;
}

}  // namespace marti::studies::schemes
