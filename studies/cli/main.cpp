// The command line. Exit status: 0 done, 2 the user's input is wrong, 1 a fault of ours.
#include <CLI/CLI.hpp>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "accel/precision.h"
#include "accel/triangles.h"
#include "scenes/gltf_export.h"
#include "scenes/open.h"
#include "scenes/procedural.h"
#include "scenes/tessellate.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/finished_parts.h"
#include "sim/input_files.h"
#include "sim/made_directory.h"
#include "sim/memory_budget.h"
#include "sim/shown.h"
#include "sim/units.h"
#include "sim/work_meter.h"
#include "studies/cli/command_error.h"
#include "studies/cli/examples.h"
#include "studies/cli/option_value.h"
#include "studies/cli/reference_commands.h"
#include "studies/cli/shell_completion.h"
#include "studies/cli/sweep_command.h"
#include "studies/compare/compare.h"
#include "studies/compare/page.h"
#include "studies/driven/driven.h"
#include "studies/error/error.h"
#include "studies/error/error_keys.h"
#include "studies/estimate/within.h"
#include "studies/explore/explore.h"
#include "studies/frames/frames.h"
#include "studies/host/host_threads.h"
#include "studies/host/image_file.h"
#include "studies/host/program_build.h"
#include "studies/host/signals_held.h"
#include "studies/keys/config_file.h"
#include "studies/keys/price_keys.h"
#include "studies/log_file/packed_file.h"
#include "studies/operations/operations.h"
#include "studies/paper/paper.h"
#include "studies/paper/paper_keys.h"
#include "studies/progress/progress_line.h"
#include "studies/report/report_command.h"
#include "studies/run/run_result.h"
#include "studies/run/saved_frame.h"
#include "studies/run/trace/trace.h"
#include "studies/show/output.h"
#include "studies/show/result_json.h"
#include "studies/show/summary.h"
#include "studies/show/verify_plan.h"
#include "studies/stability/stability.h"
#include "studies/suite/suite.h"
#include "studies/tables/page_file.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/text_units.h"
#include "studies/version.h"

namespace marti::studies::cli {

namespace {

constexpr int done = 0;
constexpr int our_fault = 1;
constexpr int wrong_input = 2;

void print(const std::string& text) {
  // The reader of standard output, such as `head`, has seen enough and is gone: no error. The command does
  // the rest of its work.
  static bool no_reader = false;
  if (no_reader) {
    return;
  }
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    no_reader = errno == EPIPE;
    if (!no_reader) {
      throw sim::UserError("standard output cannot be written");
    }
  }
}

// The options that several commands have.

CLI::Option* add_file(CLI::App* command, std::string& file) {
  return command->add_option("CONFIG", file, "configuration file (TOML); -: standard input")
      ->type_name("FILE.toml");
}

void add_assignments(CLI::App* command, std::vector<std::string>& assignments) {
  command->add_option("--set", assignments, "key=value, overrides the file; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
}

CLI::Option* add_directory(CLI::App* command, const std::string& option, std::string& directory,
                           const std::string& what) {
  return command->add_option(option, directory, what)->type_name("DIR")->check([](const std::string& name) {
    return name.empty() ? "the name of a directory must not be empty" : "";
  });
}

sim::Key integer_key(std::int64_t low, std::int64_t high) {
  sim::Key key;
  key.type = sim::ValueType::integer;
  key.minimum = low;
  key.maximum = high;
  return key;
}

sim::Key real_key(double low, double high) {
  sim::Key key;
  key.type = sim::ValueType::real;
  key.minimum = low;
  key.maximum = high;
  return key;
}

// A cost has no largest value.
void add_budget(CLI::App* command, const std::string& option, std::optional<double>& budget,
                const std::string& what) {
  sim::Key key = real_key(0.0, 0.0);
  key.maximum.reset();
  takes_value(command->add_option(option, budget, what)->type_name("COST"), key);
}

void add_page(CLI::App* command, std::string& file, const std::string& what) {
  command->add_option("-o,--output", file, what)->type_name("FILE.html")->check([](const std::string& name) {
    return name.empty() ? "the name of a file must not be empty" : "";
  });
}

struct RunArguments {
  std::string config;
  std::vector<std::string> assignments;
  std::string directory;
  bool json = false;
  std::string within;
  std::vector<std::string> keep;
  bool verify_plan = false;
  bool what_helps = false;
  bool no_what_helps = false;
  std::string log;
};

// `exact` has a meter.
void run_within_command(const RunArguments& arguments, sim::Config& config, run::RunOptions exact) {
  if (!arguments.keep.empty() || arguments.verify_plan) {
    throw sim::UserError("--keep and --verify-plan are for exact runs; leave --within out");
  }
  if (!arguments.log.empty()) {
    throw sim::UserError(
        "--within traces only a part of the frame, and --save-log needs all of it; leave one out");
  }
  if (!arguments.directory.empty()) {
    throw sim::UserError(
        "--within gives estimates of some figures: result.json and the other files of --output are for "
        "exact runs; leave --within out, or take --json");
  }
  double tolerance = 0.0;
  try {
    tolerance = estimate::parse_tolerance(arguments.within);
  } catch (const sim::UserError& error) {
    throw sim::UserError("--within: " + std::string(error.what()));
  }
  std::optional<progress::ShownMeter> shown(std::in_place, *exact.meter);
  const std::string text = estimate::run_within(config, tolerance, arguments.json, std::move(exact));
  shown.reset();  // before anything is printed
  print(text);
}

void run_command(const RunArguments& arguments) {
  sim::Schema schema = run::run_schema();
  keys::declare_price_keys(schema);
  sim::Config config = keys::read_config(schema, arguments.config, arguments.assignments);
  run::RunOptions options;
  options.directory = arguments.directory;
  options.keep = run::KeptItems(arguments.keep);
  options.what_helps = arguments.no_what_helps ? helps::Measuring::none
                       : arguments.what_helps  ? helps::Measuring::all
                                               : helps::Measuring::within_budget;
  options.prices = keys::read_given_prices(config);
  sim::WorkMeter meter;
  progress::Foreseen foreseen;
  options.meter = &meter;
  if (!arguments.within.empty()) {
    run_within_command(arguments, config, std::move(options));
    return;
  }
  const sim::MadeDirectory made = show::prepare_run(arguments.directory);
  std::optional<log_file::PackedWriter>
      log;  // a file that cannot be written is told of before the frame is traced
  if (!arguments.log.empty()) {
    log.emplace(arguments.log);
  }
  options.foreseen = &foreseen;
  std::optional<progress::ShownMeter> shown(std::in_place, meter, &foreseen);
  const run::RunResult result = run::run(config, std::move(options));
  const show::PlanVerdict verdict = arguments.verify_plan ? show::verify_plan(result) : show::PlanVerdict();
  shown.reset();  // before anything is printed
  if (!verdict.holds) {
    throw sim::InternalError("the plan is wrong\n" + verdict.text);
  }
  if (log) {
    run::save_frame(result.functional, result.frame_config.render, result.values, *log);
  }
  show::WrittenRun written;
  if (!arguments.directory.empty()) {
    written = show::write_output(result, arguments.directory);
  }
  if (log) {
    written.files.emplace_back(arguments.log);
  }
  if (arguments.json) {
    print(written.json.empty() ? show::json_of(result) : written.json);
    return;
  }
  std::string text = show::summary_of(result) + verdict.text;
  for (const std::filesystem::path& file : written.files) {
    text += "wrote         " + file.string() + "\n";
  }
  print(text);
}

// The arguments that every study takes.
struct StudyArguments {
  std::string config;
  std::vector<std::string> assignments;
  std::string directory;
};

// All that decides the parts of a study, but the files that it reads.
std::string identity_of_study(const std::string& name, const sim::Config& config) {
  const std::filesystem::path program = "/proc/self/exe";
  std::string text = std::string(host::build_of_program()) + "\n" + name + "\n";
  // Any other build, because the parts are kept as this one has them in memory.
  std::error_code unknown;
  text += std::to_string(std::filesystem::file_size(program, unknown)) + " " +
          std::to_string(std::filesystem::last_write_time(program, unknown).time_since_epoch().count());
  for (std::size_t i = 0; i < config.schema().keys().size(); ++i) {
    const sim::Key& key = config.schema().keys()[i];
    text += "\n" + key.name + " = " + sim::print_values(key, config.values_at(i));
  }
  return text;
}

// Refuses a directory with another kind of result.
sim::MadeDirectory prepare_study(const std::string& directory) {
  tables::refuse_other_results(directory, tables::database_name);
  tables::refuse_store_of_sweep(directory);
  return show::prepare_output(directory);
}

// Runs a study; without an output directory it only prints. A fault of the program that the study finds is
// thrown as InternalError, once all files are written.
template <class Study>
void run_study(const char* name, const StudyArguments& arguments, const sim::Schema& schema,
               const Study& study) {
  sim::Config config = keys::read_config_or_defaults(schema, arguments.config, arguments.assignments);
  const sim::MadeDirectory made = prepare_study(arguments.directory);
  if (!arguments.directory.empty()) {
    host::load_image_library();
  }
  sim::WorkMeter meter;
  std::optional<sim::FinishedParts> finished;
  if (!arguments.directory.empty()) {
    finished.emplace(std::filesystem::path(arguments.directory) / tables::unfinished_name,
                     identity_of_study(name, config));
    meter.keep_in(&*finished);
    if (finished->taken_up() != 0) {
      std::fprintf(stderr, "goes on where it was: %s of an earlier call\n",
                   tables::counted(finished->taken_up(), "finished part").c_str());
    }
  }
  std::optional<progress::ShownMeter> shown(std::in_place, meter);
  const tables::StudyOutput output = sim::with_places(config, [&] { return study(config, &meter); });
  shown.reset();  // before anything is printed
  std::string text = output.report;
  if (!output.host_report.empty()) {
    text += "\n" + output.host_report;
  }
  for (const tables::StudyImage& image : output.images) {
    if (const std::string note = host::note_of_infinities(image.image); !note.empty()) {
      text += "note: " + image.name + ": " + note + "\n";
    }
  }
  if (!arguments.directory.empty()) {
    text += "\n";
    for (const std::filesystem::path& file : tables::write_study(output, arguments.directory)) {
      text += "wrote " + file.string() + "\n";
    }
    finished.reset();
  }
  print(text);
  if (!output.fault.empty()) {
    throw sim::InternalError(output.fault);
  }
}

void add_study_commands(CLI::App& app, StudyArguments& arguments, suite::SuiteArguments& suite_arguments) {
  CLI::App* study = app.add_subcommand("study", "Runs a study: many machines, tables and charts");
  study->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, bool needs_file, sim::Schema (*schema)(),
                       tables::StudyOutput (*run)(sim::Config&, sim::WorkMeter*)) {
    CLI::App* command = study->add_subcommand(name, what);
    add_file(command, arguments.config)->required(needs_file);
    add_directory(command, "-o,--output", arguments.directory, "directory for tables, charts and report")
        ->required(needs_file);
    add_assignments(command, arguments.assignments);
    command->callback([&arguments, schema, run, name] { run_study(name, arguments, schema(), run); });
  };
  add("operations", "Counts the operations of every walk, a step and a ray", false, run::run_schema,
      operations::run_operations);
  add("paper", "The tables and figures of the paper of 1992", true, paper::paper_schema, paper::run_paper);
  add("frames", "The cycle \"build, render\" of each frame of an animated scene", true, run::run_schema,
      frames::run_frames);
  add("error", "Cheaper answers than exact ones: how wrong they are, and how much cheaper", true,
      error::error_schema, error::run_error);
  add("stability", "Extremes of a scene and a machine, each against an oracle; exit 1 if one fails", false,
      stability::stability_schema, stability::run_stability);
  CLI::App* const suite = study->add_subcommand(
      "suite",
      "Machines against a baseline over many scenes: the table that papers print; goes on where it was");
  add_file(suite, suite_arguments.config)->required();
  add_directory(suite, "-o,--output", suite_arguments.directory, "directory for the table, page and store")
      ->required();
  add_assignments(suite, suite_arguments.assignments);
  suite->add_flag("--quiet", suite_arguments.quiet, "no progress");
  suite->callback([&suite_arguments] { suite::suite_command(suite_arguments, print); });
}

void add_sweep_command(CLI::App& app, SweepArguments& arguments) {
  CLI::App* sweep =
      app.add_subcommand("sweep",
                         "Times every machine of a configuration's [sweep] or of axes given here; "
                         "goes on where it was");
  add_file(sweep, arguments.config)->required();
  add_assignments(sweep, arguments.assignments);
  sweep
      ->add_option(
          "--axis", arguments.axes,
          "sweeps over a key, as key=1,4,16 or key=4KiB..64KiB*2 or key=1..9+2; in the place of an axis "
          "of the file; may be repeated")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  add_directory(sweep, "-o,--output", arguments.directory, "directory for results.sqlite and points.csv");
  takes_value(sweep
                  ->add_option("--threads", arguments.threads,
                               "machines timed at a time; 0: as many as there are cores")
                  ->type_name("N"),
              integer_key(0, 4096));
  sweep
      ->add_option("--best", arguments.best,
                   "the best machines by this metric and their cost: end, speed_up, efficiency, ...")
      ->type_name("METRIC");
  add_budget(sweep, "--budget,--within", arguments.budget,
             "the cost that the best machine may have, by [prices]; --within is its old name");
  sweep
      ->add_option(
          "--share", arguments.share,
          "times only this share of the machines: 3/8 is the third of eight; the last one, or the command "
          "without --share, merges them")
      ->type_name("N/OF");
  sweep->add_flag("--plan", arguments.plan_only, "only say what would be run");
  sweep->add_flag("--quiet", arguments.quiet, "no progress");
  sweep->add_flag("--json", arguments.json, "print the points, or the best ones, as JSON");
  sweep->callback([&] { sweep_command(arguments, print); });
}

struct TraceArguments {
  std::string config;
  std::vector<std::string> assignments;
  std::string directory;
  std::string limit = "4 GiB";
  run::TraceOptions options;
};

void add_trace_command(CLI::App& app, TraceArguments& arguments) {
  CLI::App* trace =
      app.add_subcommand("trace", "Writes what nodes refer to, or ask of the memory, for other simulators");
  add_file(trace, arguments.config)->required();
  add_assignments(trace, arguments.assignments);
  add_directory(trace, "-o,--output", arguments.directory, "directory for the traces and trace.json")
      ->required();
  sim::Key format;
  format.type = sim::ValueType::choice;
  format.choices = run::trace_formats();
  takes_value(trace->add_option("--format", arguments.options.format,
                                "din: what nodes refer to, before their caches; others: what leaves their "
                                "caches, in the order of time, as the simulator of this name reads it"),
              format);
  trace->add_flag("--references", arguments.options.references,
                  "in every format what nodes refer to, before their caches: a file of each node");
  trace->add_option("--nodes", arguments.options.nodes, "which nodes, as 0-3 or 0,2,8-9; all if not given")
      ->type_name("NODES")
      ->check([](const std::string& nodes) { return nodes.empty() ? "name at least one node" : ""; });
  trace->add_option("--limit", arguments.limit, "refuse to write more than this, as \"4 GiB\"")
      ->type_name("SIZE");
  trace->callback([&] {
    try {
      arguments.options.most_bytes = static_cast<std::uint64_t>(sim::parse_size(arguments.limit));
    } catch (const sim::UserError& error) {
      throw sim::UserError("--limit: " + std::string(error.what()));
    }
    sim::Config config = keys::read_config(run::run_schema(), arguments.config, arguments.assignments);
    const sim::MadeDirectory made = show::prepare_output(arguments.directory);
    print(sim::with_places(
        config, [&] { return run::write_traces(config, arguments.options, arguments.directory); }));
  });
}

struct MemoryArguments {
  std::string config;
  std::string trace;
  std::vector<std::string> assignments;
  std::string directory;
  driven::DrivenChoices choices;
};

void add_memory_command(CLI::App& app, MemoryArguments& arguments) {
  CLI::App* command = app.add_subcommand("memory", "Drives a memory by itself with a trace of requests");
  add_file(command, arguments.config)->required();
  command
      ->add_option("TRACE", arguments.trace,
                   "requests, as CSV, or as DRAMsim3, Ramulator 2 (LoadStoreTrace) or gem5 read them")
      ->type_name("FILE")
      ->required();
  add_assignments(command, arguments.assignments);
  constexpr std::int64_t most_outstanding = 4096;
  takes_value(command
                  ->add_option("--outstanding", arguments.choices.outstanding,
                               "reads of a node under way at a time (default: 16)")
                  ->type_name("N"),
              integer_key(1, most_outstanding));
  command->add_flag("--caches", arguments.choices.caches,
                    "reads go through the nodes' private caches before the memory");
  command
      ->add_option("--axis", arguments.choices.axes,
                   "drives the memory for each value of a key, as marti sweep has axes; may be repeated")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  command->add_flag("--json", arguments.choices.json, "prints the figures as JSON");
  add_directory(command, "-o,--output", arguments.directory,
                "directory for tables and charts, for marti report");
  command->callback([&] {
    sim::Config config = keys::read_config(run::run_schema(), arguments.config, arguments.assignments);
    const sim::MadeDirectory made = prepare_study(arguments.directory);
    sim::WorkMeter meter;
    std::optional<progress::ShownMeter> shown(std::in_place, meter);
    const driven::DrivenOutput output = sim::with_places(
        config, [&] { return driven::drive(config, arguments.trace, arguments.choices, &meter); });
    shown.reset();  // before anything is printed
    std::string text = output.printed;
    if (!arguments.directory.empty()) {
      for (const std::filesystem::path& file : tables::write_study(output.files, arguments.directory)) {
        text += arguments.choices.json ? "" : "wrote " + file.string() + "\n";
      }
    }
    print(text);
  });
}

struct CompareArguments {
  std::string a;
  std::string b;
  std::string page;
  compare::CompareOptions options;
};

void compare_command(const CompareArguments& arguments) {
  if (arguments.page.empty()) {
    print(compare::compare_results(arguments.a, arguments.b, arguments.options));
    return;
  }
  tables::check_page_target(arguments.page);
  compare::ComparisonPage page;
  std::string text = compare::compare_results(arguments.a, arguments.b, arguments.options, &page);
  tables::write_page(arguments.page, compare::html_of(page));
  print(arguments.options.json ? text : text + "\nwrote " + arguments.page + "\n");
}

void add_compare_command(CLI::App& app, CompareArguments& arguments) {
  CLI::App* compare = app.add_subcommand(
      "compare", "What differs between two runs, points or sweeps, or a run and every point");
  compare->add_option("A", arguments.a, "directory of a run or sweep; DIR:N is point N of a sweep")
      ->type_name("RESULT")
      ->required();
  compare->add_option("B", arguments.b, "what A is compared with, likewise")->type_name("RESULT")->required();
  compare->add_flag("--json", arguments.options.json, "print the differences as JSON");
  compare->add_flag("--all", arguments.options.all, "all differences, and what is equal");
  add_page(compare, arguments.page, "also one HTML page: the verdict, charts, tables");
  compare->callback([&] { compare_command(arguments); });
}

void add_report_command(CLI::App& app, report::ReportArguments& arguments) {
  CLI::App* report = app.add_subcommand(
      "report", "One HTML page from a run, a sweep or a study: the answer, charts, a what-if");
  report
      ->add_option("DIR", arguments.directory,
                   "directory of a run, a sweep or a study; DIR:N for point N of a sweep")
      ->type_name("DIR")
      ->required();
  add_page(report, arguments.output, "the page; DIR/report.html or DIR/point-N.html if not given");
  add_directory(report, "--plots", arguments.plots, "directory for every chart as SVG and CSV");
  report->add_flag("--pdf", arguments.pdf, "the plots also as PDF");
  add_budget(report, "--budget", arguments.budget,
             "of a sweep: the price that a machine may have; the best within it is named");
  report->callback([&] { report::report_command(arguments, print); });
}

void add_explore_command(CLI::App& app, explore::ExploreArguments& arguments) {
  CLI::App* explore = app.add_subcommand(
      "explore",
      "A page on this computer: every setting of a machine is a control, simulated as it is moved");
  add_file(explore, arguments.config)->required();
  add_assignments(explore, arguments.assignments);
  takes_value(explore->add_option("--port", arguments.port, "of 127.0.0.1; 0: a free one")->type_name("N"),
              integer_key(0, 65535));
  takes_value(
      explore->add_option("--for", arguments.seconds, "ends by itself after this time; 0: only when asked to")
          ->type_name("SECONDS"),
      real_key(0.0, 1e6));
  explore->add_flag("--no-browser", arguments.no_browser, "only print the address");
  explore->callback([&] { explore::explore_command(arguments, print); });
}

void list_scenes() {
  std::string text;
  for (const scenes::ProceduralScene& scene : scenes::procedural_scenes()) {
    text += std::string(scene.name) + ":" + std::to_string(scene.default_size) + "  (" +
            std::to_string(scene.minimum_size) + " to " + std::to_string(scene.maximum_size) + ")  " +
            std::string(scene.meaning) + "\n";
    for (const scenes::ProceduralVariant& variant : scene.variants) {
      text += "  :" + std::string(variant.name) + "  " + std::string(variant.meaning) + "\n";
    }
  }
  print(text);
}

struct SceneArguments {
  std::string source;
  std::string target;
  scenes::FileOptions file;
};

// There is no configuration that could set a memory limit: it is the host's default.
scenes::OpenOptions options_of(const SceneArguments& arguments) {
  scenes::OpenOptions options{{}, arguments.file};
  options.file.size_first = host::size_of_image;
  options.file.memory = sim::MemoryBudget(sim::default_memory_limit());
  return options;
}

scenes::Scene open(const SceneArguments& arguments) {
  return scenes::open_scene(arguments.source, options_of(arguments), host::decode_image);
}

std::string scene_info(const SceneArguments& arguments) {
  const scenes::AnimatedScene scene =
      scenes::open_animated(arguments.source, options_of(arguments), host::decode_image);
  const scenes::Scene pose = scene.asked_for(arguments.file.time, arguments.source);
  const std::string need = accel::describe_need(accel::precision_need(accel::TriangleSet(pose)));
  return scenes::describe(pose) + (need.empty() ? "" : "note: " + need + "\n") +
         scenes::describe(scene.facts());
}

void add_scene_commands(CLI::App& app, SceneArguments& arguments) {
  CLI::App* scene = app.add_subcommand("scene", "Lists, describes and exports scenes");
  scene->require_subcommand(1);
  scene->add_subcommand("list", "Lists the procedural scenes")->callback(list_scenes);
  CLI::App* info = scene->add_subcommand("info", "Describes a scene");
  CLI::App* save = scene->add_subcommand("export", "Writes a scene, in one pose, as binary glTF");
  for (CLI::App* command : {info, save}) {
    command->add_option("SOURCE", arguments.source, "name:size, or a .gltf, .glb, .obj, .ply or .pbrt file")
        ->type_name("SCENE")
        ->required();
    command->add_option("--scene", arguments.file.scene, "scene of the file, by index or name")
        ->type_name("NAME");
    command->add_option("--camera", arguments.file.camera, "camera of the file, by index or name")
        ->type_name("NAME");
    command
        ->add_option("--animation", arguments.file.animation,
                     "animation of the file, by index or name; none: the static pose")
        ->type_name("NAME");
    command->add_option("--time", arguments.file.time, "the pose at this many seconds of the animation")
        ->type_name("SECONDS");
  }
  save->add_option("FILE", arguments.target, "the .glb file to write")->type_name("FILE.glb")->required();
  info->callback([&] { print(scene_info(arguments)); });
  save->callback([&] {
    if (!arguments.target.ends_with(".glb")) {
      throw sim::UserError(arguments.target + ": the name of a binary glTF file must end in .glb");
    }
    // A light that only the reader adds is no part of the scene; the file's reader adds it again.
    arguments.file.default_light = scenes::DefaultLight::never;
    scenes::Scene source = open(arguments);
    sim::refuse_input(arguments.target);
    scenes::tessellate(source);
    scenes::export_glb(source, arguments.target, host::encode_png);
    std::string text = "wrote " + arguments.target + "\n";
    for (const std::string& note : source.notes) {
      text += "note: " + note + "\n";
    }
    print(text);
  });
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("marti: simulates multiprocessor ray-tracing machines", "marti");
  app.set_version_flag("-V,--version", std::string(version));
  app.require_subcommand(1);

  RunArguments run_arguments;
  CLI::App* run = app.add_subcommand("run", "Runs one machine: image, statistics, summary");
  add_file(run, run_arguments.config)->required();
  add_assignments(run, run_arguments.assignments);
  add_directory(run, "-o,--output", run_arguments.directory,
                "directory for image.exr, image.png, result.json and what is recorded");
  run->add_flag("--json", run_arguments.json, "print the result as JSON instead of the summary");
  run->add_option("--within", run_arguments.within,
                  "accept an estimate whose error is at most this, as \"2 %\"")
      ->type_name("PERCENTAGE")
      ->check([](const std::string& text) {
        return text.empty() ? std::string("must be a percentage, such as \"2 %\"") : std::string();
      });
  run->add_option("--save-log", run_arguments.log,
                  "writes the work log to this file, which other configurations may then name as scene.log")
      ->type_name("FILE")
      ->check(
          [](const std::string& name) { return name.empty() ? "the name of a file must not be empty" : ""; });
  run->add_option("--keep", run_arguments.keep,
                  "does not leave this item of the plan out, or \"all\"; may be repeated")
      ->type_name("ITEM")
      ->allow_extra_args(false);
  run->add_flag("--verify-plan", run_arguments.verify_plan,
                "runs once more for each item that is left out, and proves that nothing else differs");
  CLI::Option* const what_helps =
      run->add_flag("--what-helps", run_arguments.what_helps,
                    "measures what would make the frame shorter, however long that takes; by default only as "
                    "far as it takes no longer than the run itself");
  run->add_flag("--no-what-helps", run_arguments.no_what_helps,
                "does not measure what would make the frame shorter")
      ->excludes(what_helps);
  run->callback([&] { run_command(run_arguments); });

  explore::ExploreArguments explore_arguments;
  add_explore_command(app, explore_arguments);

  StudyArguments study_arguments;
  suite::SuiteArguments suite_arguments;
  add_study_commands(app, study_arguments, suite_arguments);

  SweepArguments sweep_arguments;
  add_sweep_command(app, sweep_arguments);

  TraceArguments trace_arguments;
  add_trace_command(app, trace_arguments);

  MemoryArguments memory_arguments;
  add_memory_command(app, memory_arguments);

  CompareArguments compare_arguments;
  add_compare_command(app, compare_arguments);

  report::ReportArguments report_arguments;
  add_report_command(app, report_arguments);

  ReferenceArguments reference_arguments;
  add_reference_commands(app, reference_arguments, print);

  SceneArguments scene_arguments;
  add_scene_commands(app, scene_arguments);
  add_examples(app);

  // The shells' completion scripts call the program this way. The words to complete may be options, which
  // CLI11 must not parse as options of this call.
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words.front() == "__complete") {
    print(completions(app, all_keys(), std::span(words).subspan(1)));
    return done;
  }
  if (words.empty()) {
    print(app.help());
    return done;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 also throws for --help and --version, with exit code 0; all else is an error of the user's input.
    if (error.get_exit_code() == 0) {
      std::ostringstream text;
      const int status = app.exit(error, text, text);
      print(text.str());
      return status;
    }
    throw sim::UserError(command_error(app, error, words));
  }
  return done;
}

int run_program(int argc, char** argv) {
  // Writing to a pipe without a reader is then an error of writing, which print() knows.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its size limit is then an error of writing, like a full disk
  try {
    host::end_cleanly_on_signals();
    host::limit_threads_to_available();
    return parse_and_run(argc, argv);
  } catch (const sim::UserError& error) {
    // A message may quote control characters, which must not reach the terminal.
    std::fprintf(stderr, "marti: %s\n", sim::shown(error.what(), sim::all_shown).c_str());
    return wrong_input;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "marti: not enough memory for this scene or machine\n");
    return wrong_input;
  } catch (const std::system_error& error) {
    // std::thread throws this when the system allows no more threads.
    const bool no_thread = error.code() == std::errc::resource_unavailable_try_again;
    std::fprintf(stderr,
                 no_thread ? "marti: the system lets this process have no more threads: %s\n"
                           : "marti: internal error: %s\n",
                 error.what());
    return no_thread ? wrong_input : our_fault;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "marti: internal error: %s\n", error.what());
    return our_fault;
  }
}

}  // namespace

}  // namespace marti::studies::cli

int main(int argc, char** argv) { return marti::studies::cli::run_program(argc, argv); }
