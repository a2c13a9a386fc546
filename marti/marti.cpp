#include "marti/marti.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <future>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "sim/error.h"
#include "sim/files.h"
#include "sim/joined.h"
#include "sim/made_directory.h"
#include "sim/mapped.h"
#include "sim/nearest.h"
#include "sim/shown.h"
#include "sim/work_meter.h"
#include "studies/figures/counted_figures.h"
#include "studies/figures/derived_figures.h"
#include "studies/helps/what_helps.h"
#include "studies/host/host_threads.h"
#include "studies/host/image_file.h"
#include "studies/keys/config_file.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/price_keys.h"
#include "studies/keys/setting_value.h"
#include "studies/report/page/report_page.h"
#include "studies/report/read/read_report.h"
#include "studies/run/frame_figures.h"
#include "studies/run/run_result.h"
#include "studies/show/hits_file.h"
#include "studies/show/output.h"
#include "studies/show/result_json.h"
#include "studies/show/summary.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/store/answers.h"
#include "studies/sweep/store/points_table.h"
#include "studies/sweep/sweep.h"
#include "studies/tables/json_table.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/run_json.h"

namespace marti {

namespace {

namespace fs = std::filesystem;
using namespace studies;

/// Calls `work`, which may throw what the program's parts throw.
template <class Work>
decltype(auto) translated(const Work& work) {
  try {
    return work();
  } catch (const sim::UserError& error) {
    const sim::Place& place = error.place();
    throw Error(sim::shown(error.what(), sim::all_shown), place.file, place.line, place.key);
  } catch (const sim::Stopped&) {
    throw Interrupted();
  } catch (const std::system_error& error) {  // of threads and of file systems
    throw Error(error.what());
  }
}

/// Calls `work` with a meter. `keep_going` is asked by the calling thread, because only that one may be told
/// of Python's signals; what it throws ends the work and is thrown.
template <class Work>
auto interruptible(const KeepGoing& keep_going, const Work& work) {
  static const bool threads_limited = (host::limit_threads_to_available(), true);
  static_cast<void>(threads_limited);
  sim::WorkMeter meter;
  if (!keep_going) {
    return work(meter);
  }
  auto result = std::async(std::launch::async, [&] { return work(meter); });
  std::exception_ptr thrown;
  while (result.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
    try {
      if (!meter.is_stopped() && !keep_going()) {
        meter.stop();
      }
    } catch (...) {
      thrown = std::current_exception();
      meter.stop();
    }
  }
  if (thrown) {
    std::rethrow_exception(thrown);
  }
  return result.get();
}

sim::Config read(const sim::Schema& schema, const std::string& config, const Settings& settings) {
  if (config == "-") {
    throw sim::UserError("-: standard input is for the program; give the name of a file");
  }
  return keys::read_config_or_defaults(schema, config, settings);
}

/// A directory of its own for a result that is kept nowhere else.
class OwnDirectory {
 public:
  OwnDirectory() {
    std::string name = (fs::temp_directory_path() / "marti-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw sim::UserError(name + ": cannot be made, for results that are kept in no directory of yours");
    }
    name_ = name;
  }
  OwnDirectory(const OwnDirectory&) = delete;
  OwnDirectory& operator=(const OwnDirectory&) = delete;
  ~OwnDirectory() {
    std::error_code ignored;
    fs::remove_all(name_, ignored);
  }
  [[nodiscard]] const fs::path& name() const { return name_; }

 private:
  fs::path name_;
};

Value value_of(const tables::Cell& cell, bool is_flag) {
  if (const auto* const number = std::get_if<std::int64_t>(&cell)) {
    return is_flag ? Value(*number != 0) : Value(*number);
  }
  if (const auto* const real = std::get_if<double>(&cell)) {
    return *real;
  }
  if (const auto* const text = std::get_if<std::string>(&cell)) {
    return *text;
  }
  return {};
}

Table table_of(const tables::Table& table) {
  Table made{table.name(), table.title(), {}, {}};
  for (const tables::Column& column : table.columns()) {
    made.columns.push_back({column.name, column.unit, column.description});
  }
  for (const std::vector<tables::Cell>& row : table.rows()) {
    std::vector<Value>& values = made.rows.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      values.push_back(value_of(row[i], table.columns()[i].type == tables::ColumnType::boolean));
    }
  }
  return made;
}

std::string page_of(const report::ReportData& data) {
  report::require_vega_scripts();
  return report::report_page(data, report::vega_scripts());
}

std::string page_of(const fs::path& directory) {
  return translated([&] { return page_of(report::read_report(directory)); });
}

/// A figure of the catalogue as it stands in results: "frame." before those of the frame.
struct Known {
  std::string name;
  const figures::FigureEntry* entry = nullptr;
};

const std::vector<Known>& all_figures() {
  static const std::vector<Known> all = [] {
    std::vector<Known> known;
    const auto add = [&](std::span<const figures::FigureEntry> entries, const std::string& prefix) {
      for (const figures::FigureEntry& entry : entries) {
        known.push_back({prefix + entry.name, &entry});
      }
    };
    add(figures::derived_figures(), "");
    add(figures::counted_figures(), "");
    add(run::frame_figures(), "frame.");
    return known;
  }();
  return all;
}

Table figures_of(const tables::RunJson& run) {
  Table table{"figures",
              "What the machine took for the frame",
              {{"figure", "", "its name"},
               {"value", "", "in its unit"},
               {"unit", "", "1 for a plain number"},
               {"meaning", "", "for people"}},
              {}};
  const nlohmann::ordered_json& frame = run.at("figures.frame");
  const nlohmann::ordered_json& machine = run.at("figures.machine");
  for (const Known& known : all_figures()) {
    const bool of_frame = known.name.starts_with("frame.");
    const nlohmann::ordered_json& part = of_frame ? frame : machine;
    const auto found = part.find(known.entry->name);
    if (found != part.end() && !found->is_null()) {
      table.rows.push_back({known.name, value_of(tables::cell_of(*found), false), known.entry->unit,
                            known.entry->description});
    }
  }
  return table;
}

}  // namespace

Error::Error(const std::string& message, std::string file, int line, std::string key)
    : std::runtime_error(message), file_(std::move(file)), line_(line), key_(std::move(key)) {}

Interrupted::Interrupted() : std::runtime_error("interrupted") {}

struct Result::Data {
  std::optional<run::RunResult> live;  // of a result that is in no directory
  std::string directory;               // of one that is
  std::string json;
  std::string summary;
  Table figures;
  std::map<std::string, std::string> settings;

  void read(const tables::RunJson& run) {
    figures = figures_of(run);
    settings = keys::settings_of(run);
  }
};

Value Result::figure(std::string_view name) const {
  const auto found = std::ranges::find_if(
      data_->figures.rows, [&](const auto& row) { return row[0] == Value(std::string(name)); });
  if (found != data_->figures.rows.end()) {
    return (*found)[1];
  }
  const std::vector<std::string> names =
      sim::mapped(all_figures(), [](const Known& known) { return known.name; });
  if (std::ranges::find(names, name) == names.end()) {
    throw Error("there is no figure \"" + sim::shown(name) + "\"" + sim::did_you_mean(name, names));
  }
  return {};
}

const Table& Result::figures() const { return data_->figures; }
const std::map<std::string, std::string>& Result::settings() const { return data_->settings; }
const std::string& Result::json() const { return data_->json; }
const std::string& Result::summary() const { return data_->summary; }
const std::string& Result::directory() const { return data_->directory; }

Image Result::image() const {
  const auto rgb_of = [](const processors::program::Image& image) {
    Image made{image.width, image.height, {}};
    for (const glm::vec3& pixel : image.pixels) {
      made.rgb.insert(made.rgb.end(), {pixel.x, pixel.y, pixel.z});
    }
    return made;
  };
  return translated([&] {
    if (!data_->live) {
      return rgb_of(host::read_exr(fs::path(data_->directory) / "image.exr"));
    }
    if (data_->live->frame_config.log != nullptr) {
      throw sim::UserError("a frame from a log (scene.log) has no image");
    }
    return rgb_of(data_->live->functional.frame.image);
  });
}

std::string Result::ray_hits() const {
  return translated([&] {
    if (!data_->settings.contains("image.rays")) {
      throw sim::UserError("only image.integrator = \"rays\" says what its rays hit");
    }
    if (data_->live && data_->live->frame_config.log != nullptr) {
      throw sim::UserError("a frame from a log (scene.log) does not know what its rays hit");
    }
    return data_->live
               ? show::hits_file(data_->live->functional.frame, data_->live->functional.totals.all_rays())
               : sim::read_file(fs::path(data_->directory) / "hits.npy",
                                std::numeric_limits<std::int64_t>::max());
  });
}

std::string Result::report() const {
  if (!data_->live) {
    return page_of(data_->directory);
  }
  return translated([&] {
    const OwnDirectory own;
    show::write_output(*data_->live, own.name());
    return page_of(report::read_report(own.name()));
  });
}

void Result::save(const std::string& directory) const {
  translated([&] {
    if (!data_->live) {
      throw sim::UserError(directory + ": the result is in " + data_->directory + " already");
    }
    if (directory.empty()) {
      throw sim::UserError("the name of a directory must not be empty");
    }
    const sim::MadeDirectory made = show::prepare_run(directory);
    show::write_output(*data_->live, directory);
  });
}

struct Sweep::Data {
  std::unique_ptr<const OwnDirectory> own;  // with the points, where no directory was given
  std::string directory;
  Table points;
  std::vector<std::string> axes;
  std::string summary;
  std::vector<Table> tables;
  bool complete = false;
};

namespace {

std::shared_ptr<Sweep::Data> data_of(const sweep::SweepReader& reader, const std::string& directory) {
  auto data = std::make_shared<Sweep::Data>();
  data->directory = directory;
  data->axes = reader.axes();
  data->points = table_of(sweep::points_table(reader));
  data->complete = std::ranges::all_of(reader.points(), &sweep::StoredPoint::done);
  const sweep::Answers answers = sweep::answers_of(reader);
  data->summary = sweep::answer_text(answers) + sweep::fastest_text(reader);
  data->tables = sim::mapped(answers.tables, table_of);
  return data;
}

}  // namespace

const Table& Sweep::points() const { return data_->points; }
const std::vector<std::string>& Sweep::axes() const { return data_->axes; }
const std::string& Sweep::summary() const { return data_->summary; }
const std::vector<Table>& Sweep::tables() const { return data_->tables; }
const std::string& Sweep::directory() const { return data_->directory; }
bool Sweep::complete() const { return data_->complete; }

Table Sweep::best(const std::string& figure, std::optional<double> budget) const {
  return translated([&] {
    figures::require_direction(figure);
    const sweep::SweepReader reader(fs::path(data_->directory) / tables::database_name);
    return table_of(sweep::best_points(reader, figure, budget).front);
  });
}

std::string Sweep::report() const { return page_of(data_->directory); }

struct Study::Data {
  std::string directory;
  std::vector<Table> tables;
  std::string summary;
};

const std::vector<Table>& Study::tables() const { return data_->tables; }
const std::string& Study::summary() const { return data_->summary; }
std::string Study::report() const { return page_of(data_->directory); }

Result run(const std::string& config, const Settings& settings, const std::string& given_directory,
           const KeepGoing& keep_going) {
  const std::string directory = given_directory.empty() ? "" : fs::absolute(given_directory).string();
  return translated([&] {
    return interruptible(keep_going, [&](sim::WorkMeter& meter) {
      sim::Schema schema = run::run_schema();
      keys::declare_price_keys(schema);
      sim::Config read_config = read(schema, config, settings);
      const sim::MadeDirectory made = show::prepare_run(directory);
      run::RunOptions options;
      options.directory = directory;
      options.what_helps = helps::Measuring::within_budget;
      options.prices = keys::read_given_prices(read_config);
      options.meter = &meter;
      auto data = std::make_shared<Result::Data>();
      data->live.emplace(run::run(read_config, std::move(options)));
      data->live->frame_config.wait_with(nullptr);
      data->summary = show::summary_of(*data->live);
      if (directory.empty()) {
        data->json = show::json_of(*data->live);
      } else {
        data->json = show::write_output(*data->live, directory).json;
        data->directory = directory;
        data->live.reset();
      }
      data->read(tables::RunJson(nlohmann::ordered_json::parse(data->json), config));
      return Result(std::move(data));
    });
  });
}

Sweep sweep(const std::string& config, const std::vector<std::string>& axes, const SweepChoices& choices,
            const KeepGoing& keep_going) {
  return translated([&] {
    return interruptible(keep_going, [&](sim::WorkMeter& meter) {
      if (!choices.share.empty() && choices.directory.empty()) {
        throw sim::UserError("a share is timed into a directory, with those of others; give its name");
      }
      auto own = choices.directory.empty() ? std::make_unique<const OwnDirectory>() : nullptr;
      sweep::SweepOptions options;
      options.directory = own ? own->name() : fs::absolute(choices.directory);
      options.threads = choices.threads;
      options.quiet = true;
      if (!choices.share.empty()) {
        options.share = sweep::share_named(choices.share);
      }
      sim::Config read_config = read(sweep::sweep_schema(), config, choices.settings);
      sweep::SweepPlan plan = sweep::plan_sweep(read_config, axes, &meter);
      sweep::leave_out_unfit(plan, options.directory);
      sweep::check_question(plan.question, plan.axes);
      const sweep::SweepReport report =
          sweep::run_sweep(plan, options, keys::read_memory(read_config, sweep::processes_beside()),
                           [](const std::string&) {});
      auto data = report.reader ? data_of(*report.reader, options.directory.string())
                                : std::make_shared<Sweep::Data>();
      data->directory = options.directory.string();
      if (!report.reader) {
        data->summary = "other shares are not done: the last one merges them, or a sweep without a share\n";
      }
      data->own = std::move(own);
      return Sweep(std::move(data));
    });
  });
}

std::variant<Result, Sweep, Study> open(const std::string& given_directory) {
  return translated([&]() -> std::variant<Result, Sweep, Study> {
    if (!fs::is_directory(given_directory)) {
      throw sim::UserError(given_directory + ": there is no such directory");
    }
    const std::string directory = fs::absolute(given_directory).string();
    const report::ReportData report = report::read_report(directory);
    if (report.kind == "run") {
      auto data = std::make_shared<Result::Data>();
      data->directory = directory;
      const tables::RunJson run = tables::read_run_json(fs::path(directory) / tables::run_name);
      data->json = tables::json_text(run.json());
      data->summary = sim::joined(report.answer, "\n") + "\n";
      data->read(run);
      return Result(std::move(data));
    }
    if (report.kind == "sweep") {
      return Sweep(data_of(sweep::SweepReader(fs::path(directory) / tables::database_name), directory));
    }
    auto data = std::make_shared<Study::Data>();
    data->directory = directory;
    data->summary = report.text;
    for (const report::ReportTable& table : report.tables) {
      data->tables.push_back(table_of(table.table));
    }
    return Study(std::move(data));
  });
}

}  // namespace marti
