#include "studies/suite/suite_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "scenes/open.h"
#include "scenes/scene_list.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/sha256.h"
#include "sim/shown.h"
#include "studies/sweep/plan/table_texts.h"

namespace marti::studies::suite {

namespace {

using sim::DocumentValue;

constexpr std::size_t most_scenes = 1000;
constexpr std::size_t longest_name = 60;
constexpr std::string_view name_of_mean = "geometric mean";  // in the column of scenes

class SuiteReader {
 public:
  explicit SuiteReader(const sim::Config& config)
      : config_(config), directory_(std::filesystem::path(config.name()).parent_path()) {}

  SuiteFile read() {
    const DocumentValue::Table& section = config_.free_section("suite");
    const int line = config_.free_section_line("suite");
    if (section.empty()) {
      sim::fail_at(config_, std::max(1, line), "suite",
                   "is missing: the baseline, and a table [[suite.scene]] for each scene");
    }
    const sweep::TableTexts texts(config_, section, line, "suite", {"baseline", "scene"});
    suite_.baseline = texts.text("baseline");
    suite_.place = texts.place("baseline");
    const DocumentValue::List* const list = texts.entry("scene").value.list();
    if (list == nullptr || list->empty() || list->size() > most_scenes) {
      texts.fail("scene", "must be 1 to 1000 tables, [[suite.scene]]");
    }
    for (const DocumentValue& scene : *list) {
      if (scene.table() == nullptr) {
        texts.fail("scene", "must be a table, not " + describe(scene));
      }
      add({config_,
           *scene.table(),
           scene.line,
           "suite.scene",
           {"name", "source", "found", "licence", "sha256"}});
    }
    return std::move(suite_);
  }

 private:
  void add(const sweep::TableTexts& texts) {
    SuiteScene scene;
    scene.name = texts.text("name");
    const bool plain = std::ranges::all_of(
        scene.name, [](char c) { return c >= ' ' && c <= '~' && c != '\'' && c != '"' && c != '\\'; });
    if (!plain || scene.name.size() > longest_name) {
      texts.fail("name",
                 "must have 1 to 60 printable ASCII characters without quotation marks and backslashes");
    }
    if (scene.name.starts_with(name_of_mean)) {
      texts.fail("name", "stands in the table for the mean of all scenes; give the scene another name");
    }
    const DocumentValue& source = texts.entry("source").value;
    scene.source = source.text() != nullptr ? *source.text() : print_in_line(source);
    from_here_.push_back(from_here(texts, scene));
    scene.line = texts.entry("source").line;
    scene.found = texts.text_or_none("found");
    static_cast<void>(texts.text_or_none("licence"));
    const std::string sha256 = texts.text_or_none("sha256");
    if (!sha256.empty() && (scenes::is_scene_list(scene.source) || !scenes::names_a_file(scene.source) ||
                            scene.source.ends_with('/') || !is_sha256(sha256))) {
      texts.fail("sha256", "is that of a source that is one file, as 64 of the digits 0 to 9 and a to f");
    }
    look_for(scene, sha256);
    for (std::size_t i = 0; i < suite_.scenes.size(); ++i) {
      if (suite_.scenes[i].name == scene.name || from_here_[i] == from_here_.back()) {
        texts.fail("has the name or the source of another scene, " + suite_.scenes[i].name);
      }
    }
    suite_.scenes.push_back(std::move(scene));
  }

  // The source as it is named from the current directory. Refuses a list of sources that cannot be read.
  [[nodiscard]] std::string from_here(const sweep::TableTexts& texts, const SuiteScene& scene) const {
    try {
      if (scenes::is_scene_list(scene.source)) {
        static_cast<void>(scenes::read_scene_list(scene.source));
      }
      return scenes::source_from(scene.source, directory_);
    } catch (const sim::UserError& error) {
      texts.fail("source", scene.name + ": " + error.what());
    }
  }

  static bool is_sha256(const std::string& text) {
    return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  }

  void look_for(SuiteScene& scene, const std::string& sha256) const {
    std::vector<std::string> sources = {scene.source};
    if (scenes::is_scene_list(scene.source)) {
      sources.clear();
      for (const scenes::ListedScene& entry : scenes::read_scene_list(scene.source)) {
        sources.push_back(entry.source);
      }
    }
    for (const std::string& source : sources) {
      std::error_code error;
      if (scenes::names_a_file(source) && !std::filesystem::exists(directory_ / source, error)) {
        scene.missing = "there is no " + sim::shown(source);
        return;
      }
    }
    if (!sha256.empty() && sim::sha256_of_file(directory_ / scene.source) != sha256) {
      scene.missing = sim::shown(scene.source) + " is another file: its SHA-256 is not " + sim::shown(sha256);
    }
  }

  const sim::Config& config_;
  std::filesystem::path directory_;
  SuiteFile suite_;
  std::vector<std::string> from_here_;  // the sources of its scenes, and of the one that is read
};

std::string quoted(const std::string& text) {
  std::string literal = "'";
  for (const char c : text) {
    literal += c == '\'' ? "''" : std::string(1, c);
  }
  return literal + "'";
}

// "(VALUES ('a', 0), ('b', 1))": what `columns` gives of each item, with its place.
template <class Items, class Columns>
std::string rows_of(const Items& items, const Columns& columns) {
  std::string rows;
  std::size_t place = 0;
  for (const auto& item : items) {
    rows += fmt::format("{}({}, {})", place == 0 ? "" : ", ", columns(item), place);
    ++place;
  }
  return "(VALUES " + rows + ")";
}

sweep::QuestionTable left_out_table(const Compared& compared, const sim::Place& place) {
  const std::string rows = rows_of(compared.left_out, [](const LeftOut& what) {
    return quoted(what.scene) + ", " + (what.machine.empty() ? "NULL" : quoted(what.machine)) + ", " +
           quoted(what.reason);
  });
  return {
      "suite_left_out",
      "Left out",
      {"SELECT column1 AS scene, column2 AS machine, column3 AS reason FROM " + rows + " ORDER BY column4",
       place}};
}

}  // namespace

SuiteFile read_suite(const sim::Config& config) { return SuiteReader(config).read(); }

sweep::Question question_of(const SuiteFile& suite, const Compared& compared) {
  // Each machine beside the baseline on each scene; p is empty where it has no result.
  const std::string pairs = fmt::format(
      "{} AS s CROSS JOIN {} AS m JOIN points b ON b.point = {} AND b.\"scene.source\" = s.column2 LEFT JOIN "
      "points p ON p.point = m.column1 AND p.\"scene.source\" = s.column2",
      rows_of(compared.scenes,
              [](const SuiteScene* scene) { return quoted(scene->name) + ", " + quoted(scene->source); }),
      rows_of(compared.machines, quoted), quoted(suite.baseline));
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> shares = {
      {{"speedup", "1.0 * b.end / p.end"},
       {"relative_energy", "1.0 * p.energy / b.energy"},
       {"relative_energy_delay", "1.0 * p.energy_delay / b.energy_delay"},
       {"relative_misses", "1.0 * p.misses / b.misses"},
       {"relative_traffic", "1.0 * p.memory_bytes_read / b.memory_bytes_read"}}};
  std::string each;
  std::string means;
  for (const auto& [column, value] : shares) {
    each += fmt::format(", {} AS {}", value, column);
    // Without a value where a scene has none, so that no mean of a machine is of fewer scenes than another.
    means += fmt::format(", CASE WHEN COUNT({0}) = COUNT(p.point) THEN exp(avg(ln({0}))) END AS {1}", value,
                         column);
  }
  const std::size_t all = compared.scenes.size();
  const sim::Place place = suite.place;
  sweep::Question question;
  question.asks = "How much faster than " + suite.baseline + " are the machines?";
  question.answer = {
      fmt::format("SELECT CASE WHEN COUNT(p.point) = 0 THEN m.column1 || ' has a result on none of the "
                  "scenes' ELSE printf('%s is %.2f times as fast as %s in the geometric mean of %s (%.2f to "
                  "%.2f)', m.column1, exp(avg(ln(1.0 * b.end / p.end))), b.point, CASE WHEN COUNT(p.point) = "
                  "{1} THEN '{1} scene{2}' ELSE COUNT(p.point) || ' of {1} scenes' END, MIN(1.0 * b.end / "
                  "p.end), MAX(1.0 * b.end / p.end)) END FROM {0} GROUP BY m.column2 ORDER BY m.column2",
                  pairs, all, all == 1 ? "" : "s"),
      place};
  question.tables.push_back(
      {"suite",
       "Machines against " + suite.baseline +
           ": its frame time over theirs, and what they take as shares of it",
       {fmt::format("SELECT * FROM (SELECT s.column1 AS scene, m.column1 AS machine{0}, p.end / 1e9 AS "
                    "frame_ms FROM {1} ORDER BY m.column2, s.column3) UNION ALL SELECT * FROM (SELECT "
                    "'{2}' || CASE WHEN COUNT(p.point) = {3} THEN '' ELSE ' of ' || COUNT(p.point) || ' of "
                    "{3} scenes' END, m.column1{4}, NULL FROM {1} GROUP BY m.column2 ORDER BY m.column2)",
                    each, pairs, name_of_mean, all, means),
        place}});
  if (!compared.left_out.empty()) {
    question.tables.push_back(left_out_table(compared, place));
  }
  return question;
}

}  // namespace marti::studies::suite
