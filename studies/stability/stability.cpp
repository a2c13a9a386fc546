#include "studies/stability/stability.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "processors/program/render.h"
#include "sim/finished_parts.h"
#include "sim/nearest.h"
#include "sim/shown.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/open_frame.h"
#include "studies/run/prepared_frame.h"
#include "studies/run/run_result.h"
#include "studies/stability/moved_scene.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::stability {

namespace {

// The cases that the configuration chooses.
std::vector<StabilityCase> chosen_of(const sim::Config& config, std::span<const StabilityCase> all) {
  const std::vector<std::string> only = config.texts("stability.only");
  std::vector<std::string> names;
  std::vector<StabilityCase> chosen;
  for (const StabilityCase& one : all) {
    names.push_back(one.id);
    if (only.empty() || std::ranges::find(only, one.id) != only.end()) {
      chosen.push_back(one);
    }
  }
  for (const std::string& name : only) {
    if (std::ranges::find(names, name) == names.end()) {
      config.fail("stability.only",
                  "there is no case \"" + sim::shown(name) + "\"" + sim::did_you_mean(name, names));
    }
  }
  return chosen;
}

void prepare(const sim::Config& config, double side, Subject& subject) {
  subject.scene = run::open_frame(subject.frame);
  if (!subject.scene.instances.empty()) {
    config.fail("structure.instances", "the cases aim at triangles in their places; set \"copied\"");
  }
  const run::PreparedFrame prepared(subject.frame, subject.scene);
  subject.frame = prepared.config();  // what is left of the memory
  subject.triangles = prepared.triangles();
  subject.structure = prepared.structure();
  if (subject.triangles->size() == 0) {
    config.fail("scene.source", "the scene has nothing that a ray could hit");
  }
  const auto small = keys::made_small(subject.frame.render, side);
  subject.log = processors::program::render(subject.scene, *subject.triangles, *subject.structure, small).log;
}

tables::Table empty_table() {
  return tables::Table(
      "stability", "Extreme cases of the scene and the machine",
      {tables::text_column("group", "what is tried"), tables::text_column("case", "its name"),
       tables::text_column("what_could_go_wrong", "what breaks where no care is taken"),
       tables::text_column("oracle", "what must hold instead"),
       tables::text_column("figure", "what was found"),
       tables::real_column("objection", "1", "how many the oracle objects to; nan when the case ended early"),
       tables::text_column("verdict", "pass, FAIL or not measured")});
}

}  // namespace

CaseOutcome none_wrong(const Tally& tally, std::string_view what) {
  if (tally.of == 0) {
    return {fmt::format("no {} tried", what), 1.0};
  }
  return {fmt::format("{} of {} {}", tables::grouped(tally.wrong), tables::grouped(tally.of), what),
          static_cast<double>(tally.wrong)};
}

CaseOutcome not_tried(std::string_view why) { return {std::string(why), 0.0, false}; }

CaseOutcome run_case(const StabilityCase& one, const Subject& subject) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  try {
    return one.run(subject);
  } catch (const sim::Stopped&) {
    throw;  // the user no longer waits for the study
  } catch (const std::exception& error) {
    return {std::string("ended by: ") + error.what(), nothing};
  }
}

std::vector<StabilityCase> stability_cases() {
  std::vector<StabilityCase> cases;
  add_ray_cases(cases);
  add_machine_cases(cases);
  return cases;
}

void declare_stability_keys(sim::Schema& schema) {
  schema.section("stability",
                 "only for `marti study stability`, which tries extremes of the scene and the machine");
  schema.integer("stability.rays", 1000, {100, 10'000'000}, "rays",
                 "of each case of rays; each is tested against every primitive of the scene");
  schema.integer("stability.side", 24, {1, 512}, "pixels",
                 "of the image's longer side at most, in the frame that the machines time");
  schema.integer("stability.nodes", 65'536, {16, 1 << 20}, "",
                 "nodes in each cluster of the largest machine that is tried");
  schema.texts("stability.only", {}, "cases that are run, by their names in the table; empty: all");
}

sim::Schema stability_schema() {
  sim::Schema schema = run::run_schema();
  declare_stability_keys(schema);
  return schema;
}

tables::StudyOutput run_stability(sim::Config& config, sim::WorkMeter* meter) {
  return run_stability(config, stability_cases(), meter);
}

tables::StudyOutput run_stability(sim::Config& config, std::span<const StabilityCase> all,
                                  sim::WorkMeter* meter) {
  Subject subject;
  subject.frame = keys::read_one_frame(config, keys::FrameUse::stability);
  subject.frame.wait_with(meter);
  subject.machine = keys::read_machine(config);
  // What is counted or worked out from counters changes no time.
  subject.machine.count = {};
  subject.machine.energy = {};
  (void)keys::read_record(config, true);  // a file for `marti run` may ask for it; here nothing is recorded
  subject.rays = keys::count(config, "stability.rays");
  subject.nodes = keys::count(config, "stability.nodes");
  const std::uint32_t side = keys::count(config, "stability.side");
  const std::vector<StabilityCase> cases = chosen_of(config, all);
  config.refuse_unused();
  prepare(config, side, subject);

  tables::StudyOutput output;
  tables::Table table = empty_table();
  std::vector<std::string> failed;
  std::size_t passed = 0;
  sim::plan_parts(meter, "cases", cases.size());
  for (const StabilityCase& one : cases) {
    sim::begin_part(meter, "trying " + one.id);
    CaseOutcome outcome;
    sim::once(
        meter, "cases", one.id, [&] { outcome = run_case(one, subject); }, outcome.figure, outcome.objection,
        outcome.tried);
    table.add_row({one.group == CaseGroup::scene ? "scene" : "machine", one.id, one.risk, one.oracle,
                   outcome.figure, outcome.objection, outcome.verdict()});
    passed += outcome.tried && outcome.passed() ? 1U : 0U;
    if (!outcome.passed()) {
      failed.push_back(one.id);
    }
  }
  const tables::Table precision = precision_table(subject);
  output.report =
      fmt::format("Extremes of {}, {}, and of its machine, {}\n\n{}\n{}\n{}, {} passed, {} failed",
                  subject.frame.scene, tables::counted(subject.triangles->size(), "primitive"),
                  tables::counted(subject.machine.all_nodes(), "node"), tables::text_of(table),
                  tables::text_of(precision), tables::counted(cases.size(), "case"), passed, failed.size());
  if (passed + failed.size() < cases.size()) {
    output.report += fmt::format(", {} not measured", cases.size() - passed - failed.size());
  }
  if (!failed.empty()) {
    const std::string names = fmt::format("{}", fmt::join(failed, ", "));
    output.report += ": " + names;
    output.fault = fmt::format("{} of {} cases failed: {}", failed.size(), cases.size(), names);
  }
  output.report += "\n";
  output.tables = {std::move(table), precision, tables::provenance_table(config.effective_values())};
  return output;
}

}  // namespace marti::studies::stability
