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

class SuiteReader {
 public:
  explicit SuiteReader(const sim::Config& config)
      : config_(config), directory_(std::filesystem::absolute(config.name()).parent_path()) {}

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
    scene.source = source_of(texts);
    scene.line = texts.entry("source").line;
    scene.found = texts.text_or_none("found");
    static_cast<void>(texts.text_or_none("licence"));
    const std::string sha256 = texts.text_or_none("sha256");
    if (!sha256.empty() && (scenes::is_scene_list(scene.source) || !scenes::names_a_file(scene.source) ||
                            scene.source.ends_with('/') || !is_sha256(sha256))) {
      texts.fail("sha256", "is that of a source that is one file, as 64 of the digits 0 to 9 and a to f");
    }
    look_for(scene, sha256);
    for (const SuiteScene& other : suite_.scenes) {
      if (other.name == scene.name || other.source == scene.source) {
        texts.fail("has the name or the source of another scene, " + other.name);
      }
    }
    suite_.scenes.push_back(std::move(scene));
  }

  // A text, or what scene.source may be beside it.
  [[nodiscard]] std::string source_of(const sweep::TableTexts& texts) const {
    const DocumentValue& value = texts.entry("source").value;
    const std::string source = value.text() != nullptr ? *value.text() : print_in_line(value);
    try {
      return scenes::source_from(source, directory_);
    } catch (const sim::UserError& error) {
      texts.fail("source", error.what());
    }
  }

  static bool is_sha256(const std::string& text) {
    return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  }

  static void look_for(SuiteScene& scene, const std::string& sha256) {
    std::vector<std::string> sources = {scene.source};
    if (scenes::is_scene_list(scene.source)) {
      sources.clear();
      for (const scenes::ListedScene& entry : scenes::read_scene_list(scene.source)) {
        sources.push_back(entry.source);
      }
    }
    for (const std::string& source : sources) {
      std::error_code error;
      if (scenes::names_a_file(source) && !std::filesystem::exists(source, error)) {
        scene.missing = "there is no " + sim::shown(source);
        return;
      }
    }
    if (!sha256.empty() && sim::sha256_of_file(scene.source) != sha256) {
      scene.missing = sim::shown(scene.source) + " is another file: its SHA-256 is not " + sim::shown(sha256);
    }
  }

  const sim::Config& config_;
  std::filesystem::path directory_;
  SuiteFile suite_;
};

std::string quoted(const std::string& text) {
  std::string literal = "'";
  for (const char c : text) {
    literal += c == '\'' ? "''" : std::string(1, c);
  }
  return literal + "'";
}

}  // namespace

SuiteFile read_suite(const sim::Config& config) { return SuiteReader(config).read(); }

sweep::Question question_of(const SuiteFile& suite) {
  std::vector<const SuiteScene*> there;
  std::string name = "CASE p.\"scene.source\"";
  for (const SuiteScene& scene : suite.scenes) {
    if (scene.missing.empty()) {
      there.push_back(&scene);
      name += " WHEN " + quoted(scene.source) + " THEN " + quoted(scene.name);
    }
  }
  name += " END";
  std::string same = "b.\"scene.source\" = p.\"scene.source\" AND ";
  if (there.size() == 1) {  // what is alike in all points is no column
    name = quoted(there.front()->name);
    same.clear();
  }
  // Each machine beside the baseline of its scene.
  const std::string pairs = fmt::format("points p, points b WHERE {}b.point = {} AND p.point <> b.point",
                                        same, quoted(suite.baseline));
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
    // Without a value where a scene has none, so that no mean is of fewer scenes than another.
    means +=
        fmt::format(", CASE WHEN COUNT({0}) = COUNT(*) THEN exp(avg(ln({0}))) END AS {1}", value, column);
  }
  const sim::Place place = suite.place;
  sweep::Question question;
  question.asks = "How much faster than " + suite.baseline + " are the machines?";
  question.answer = {
      fmt::format("SELECT printf('%s is %.2f times as fast as %s in the geometric mean of %d scenes (%.2f to "
                  "%.2f)', p.point, exp(avg(ln(1.0 * b.end / p.end))), b.point, COUNT(*), MIN(1.0 * b.end / "
                  "p.end), MAX(1.0 * b.end / p.end)) FROM {} GROUP BY p.point ORDER BY MIN(p.ordinal)",
                  pairs),
      place};
  question.tables.push_back(
      {"suite",
       "Machines against " + suite.baseline +
           ": its frame time over theirs, and what they take as shares of it",
       {fmt::format("SELECT * FROM (SELECT {} AS scene, p.point AS machine{}, p.end / 1e9 AS frame_ms FROM "
                    "{} ORDER BY "
                    "p.ordinal) UNION ALL SELECT * FROM (SELECT 'geometric mean', p.point{}, NULL FROM {} "
                    "GROUP BY p.point ORDER BY MIN(p.ordinal))",
                    name, each, pairs, means, pairs),
        place}});
  return question;
}

}  // namespace marti::studies::suite
