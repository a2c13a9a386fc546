#include "studies/sweep/store/store_plan.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "sim/error.h"
#include "sim/joined.h"
#include "sim/mapped.h"
#include "studies/keys/price_keys.h"
#include "studies/sweep/store/store_schema.h"
#include "studies/version.h"

namespace marti::studies::sweep {

namespace {

// Numbers for settings, and for the sets of settings that one section of a configuration has: machines of a
// sweep share nearly all of them.
class Settings {
 public:
  explicit Settings(tables::SqliteConnection& connection)
      : add_setting_(connection, tables::insert_sql("settings", 3)),
        add_section_(connection, tables::insert_sql("sections", 2)) {
    tables::SqliteStatement settings(connection, "SELECT id, key, value FROM settings");
    while (settings.next()) {
      settings_[{settings.text(1), settings.text(2)}] = settings.integer(0);
      next_setting_ = std::max(next_setting_, settings.integer(0) + 1);
    }
    tables::SqliteStatement sections(connection,
                                     "SELECT section, setting FROM sections ORDER BY section, setting");
    std::map<std::int64_t, std::vector<std::int64_t>> known;
    while (sections.next()) {
      known[sections.integer(0)].push_back(sections.integer(1));
    }
    for (const auto& [id, members] : known) {
      sections_[members] = id;
      next_section_ = id + 1;
    }
  }

  SharedSettings shared(std::vector<sim::EffectiveValue> settings) {
    return pool_.share(std::move(settings));
  }

  // The sections of settings, ascending.
  std::vector<std::int64_t> sections_of(const SharedSettings& settings) {
    std::vector<std::int64_t> sections;
    for (const SettingsPart& part : settings) {
      const auto [known, is_new] = section_of_part_.try_emplace(part.get(), 0);
      if (is_new) {
        known->second = section_of(*part);
      }
      sections.push_back(known->second);
    }
    std::ranges::sort(sections);
    sim::ensure(std::ranges::adjacent_find(sections) == sections.end(),
                "a machine of a sweep has a setting twice");
    return sections;
  }

 private:
  std::int64_t setting(const sim::EffectiveValue& value) {
    const auto [at, is_new] = settings_.try_emplace({value.key, value.value}, next_setting_);
    if (is_new) {
      add_setting_.run({next_setting_++, value.key, value.value});
    }
    return at->second;
  }

  std::int64_t section_of(const std::vector<sim::EffectiveValue>& values) {
    std::vector<std::int64_t> members =
        sim::mapped(values, [&](const sim::EffectiveValue& value) { return setting(value); });
    std::ranges::sort(members);
    const auto [at, is_new] = sections_.try_emplace(members, next_section_);
    if (is_new) {
      for (const std::int64_t member : members) {
        add_section_.run({next_section_, member});
      }
      ++next_section_;
    }
    return at->second;
  }

  tables::SqliteStatement add_setting_;
  tables::SqliteStatement add_section_;
  std::map<std::pair<std::string, std::string>, std::int64_t> settings_;
  std::map<std::vector<std::int64_t>, std::int64_t> sections_;
  SettingsPool pool_;  // of what is not shared yet: parts are known by their addresses
  std::unordered_map<const void*, std::int64_t> section_of_part_;
  std::int64_t next_setting_ = 1;
  std::int64_t next_section_ = 1;
};

// The ids of frames or machines, in their order. Calls `add` for those whose keys the table lacks, with a new
// id.
template <class Wanted, class Add>
std::vector<std::int64_t> enter(tables::SqliteConnection& connection, const std::string& table,
                                const std::vector<Wanted>& all, const Add& add) {
  std::unordered_map<std::string, std::int64_t> known;
  std::int64_t next = 1;
  tables::SqliteStatement rows(connection, "SELECT id, key FROM " + table);
  while (rows.next()) {
    known[rows.text(1)] = rows.integer(0);
    next = std::max(next, rows.integer(0) + 1);
  }
  std::vector<std::int64_t> ids;
  ids.reserve(all.size());
  for (const Wanted& wanted : all) {
    const auto [at, is_new] = known.try_emplace(wanted.key, next);
    if (is_new) {
      add(next++, wanted);
    }
    ids.push_back(at->second);
  }
  return ids;
}

void add_sections(tables::SqliteStatement& insert, std::int64_t whose,
                  const std::vector<std::int64_t>& sections) {
  for (const std::int64_t section : sections) {
    insert.run({whose, section});
  }
}

std::vector<std::int64_t> enter_frames(tables::SqliteConnection& connection, const SweepPlan& plan,
                                       Settings& settings) {
  tables::SqliteStatement insert(connection, tables::insert_sql("frames", 2));
  tables::SqliteStatement section(connection, tables::insert_sql("frame_sections", 2));
  return enter(connection, "frames", plan.frames, [&](std::int64_t id, const SweepFrame& frame) {
    insert.run({id, frame.key});
    add_sections(section, id, settings.sections_of(settings.shared(frame.settings)));
  });
}

std::vector<std::int64_t> enter_machines(tables::SqliteConnection& connection, const SweepPlan& plan,
                                         const std::vector<std::int64_t>& frames, Settings& settings) {
  tables::SqliteStatement insert(connection, tables::insert_sql("machines", 3));
  tables::SqliteStatement section(connection, tables::insert_sql("machine_sections", 2));
  return enter(connection, "machines", plan.machines, [&](std::int64_t id, const SweepMachine& machine) {
    insert.run({id, machine.key, frames.at(machine.frame)});
    add_sections(section, id, settings.sections_of(machine.settings));
  });
}

tables::Cell axis_cell(const sim::Value& value) {
  if (const auto* flag = std::get_if<bool>(&value)) {
    return std::int64_t{*flag ? 1 : 0};
  }
  return std::visit([](const auto& number_or_text) { return tables::Cell(number_or_text); }, value);
}

void enter_points(tables::SqliteConnection& connection, const SweepPlan& plan,
                  const std::vector<std::int64_t>& machines) {
  create_points(connection, plan);
  tables::SqliteStatement insert(connection, tables::insert_sql("points", 4 + plan.axes.size()));
  std::int64_t ordinal = 0;
  for (const SweepPoint& point : plan.points) {
    sim::ensure(point.values.size() == plan.axes.size(), "a point of a sweep lacks a value");
    std::vector<tables::Cell> cells = {ordinal++, machines.at(point.machine), machines.at(point.base),
                                       point.cost};
    std::ranges::transform(point.values, std::back_inserter(cells), axis_cell);
    insert.run(cells);
  }
}

void enter_question(tables::SqliteConnection& connection, const Question& question) {
  connection.execute("DELETE FROM question");
  if (question.asks.empty()) {
    return;
  }
  tables::SqliteStatement insert(connection, tables::insert_sql("question", 8));
  std::int64_t position = 0;
  const auto add = [&](const char* kind, const std::string& name, const std::string& text, const Query& query,
                       const Query& agrees = {}) {
    insert.run({position++, kind, name, text, query.sql, query.place.text, agrees.sql, agrees.place.text});
  };
  add("answer", "", question.asks, question.answer);
  for (const QuestionTable& table : question.tables) {
    add("table", table.name, table.title, table.rows);
  }
  for (const QuestionClaim& claim : question.claims) {
    add("claim", claim.subject, claim.says, claim.here, claim.agrees);
  }
}

void enter_provenance(tables::SqliteConnection& connection, const SweepPlan& plan) {
  connection.execute("DELETE FROM provenance");
  tables::SqliteStatement insert(connection, tables::insert_sql("provenance", 2));
  insert.run({"version", version});
  insert.run({"axes", sim::joined(plan.axes)});
  if (!plan.study.empty()) {
    insert.run({"study", plan.study});
  }
  // They rank what would help, so that other prices give another plan.
  insert.run({"prices", plan.prices ? keys::text_of(*plan.prices) : std::string()});
  insert.run({"points", std::to_string(plan.points.size())});
  insert.run({"filtered_out", std::to_string(plan.filtered_out)});
  insert.run({"machines", std::to_string(plan.machines.size())});
  insert.run({"frames", std::to_string(plan.frames.size())});
}

}  // namespace

StoreIds enter_plan(tables::SqliteConnection& connection, const SweepPlan& plan) {
  Settings settings(connection);
  StoreIds ids;
  ids.frames = enter_frames(connection, plan, settings);
  ids.machines = enter_machines(connection, plan, ids.frames, settings);
  enter_points(connection, plan, ids.machines);
  connection.execute("DELETE FROM compare");
  if (plan.compare) {
    tables::SqliteStatement(connection, tables::insert_sql("compare", 1))
        .run({ids.machines.at(*plan.compare)});
  }
  enter_question(connection, plan.question);
  enter_provenance(connection, plan);
  return ids;
}

}  // namespace marti::studies::sweep
