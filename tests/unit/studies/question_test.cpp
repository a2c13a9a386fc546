// The question of a sweep: queries from a file of somebody else, what they may do, and what becomes of them.
#include "studies/sweep/plan/question.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "sim/config.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/store/answers.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/tables/query_sandbox.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_parts.h"
#include "tests/unit/studies/sweep_tables.h"

namespace marti::studies {

using namespace sweep;
using namespace tables;

namespace {

namespace fs = std::filesystem;
using test::user_error_of;

QuerySandbox three_rows() {
  QuerySandbox sandbox("points", {"machine.nodes", "end", "name"});
  for (const std::int64_t nodes : {1, 4, 16}) {
    const std::vector<Cell> row = {nodes, 1'600'000'000 / nodes, nodes == 4 ? Cell() : Cell("n")};
    sandbox.add_row(row);
  }
  return sandbox;
}

TEST(QuerySandbox, GivesRowsOfAnyType) {
  QuerySandbox sandbox = three_rows();
  std::set<std::string> reads;
  const QuerySandbox::Rows found = sandbox.run(
      "SELECT \"machine.nodes\", end / 3.0 AS third, shown(end, 'ps') AS text, name FROM points; ",
      sim::Place{"f:1: k"}, &reads);
  EXPECT_EQ(found.names, (std::vector<std::string>{"machine.nodes", "third", "text", "name"}));
  ASSERT_EQ(found.rows.size(), 3U);
  EXPECT_EQ(found.rows[1], (std::vector<Cell>{std::int64_t{4}, 400'000'000 / 3.0, "400.000 us", Cell()}));
  EXPECT_EQ(reads, (std::set<std::string>{"end", "machine.nodes", "name"}));
  EXPECT_EQ(sandbox.run("SELECT count(*) FROM points", {}).rows.front().front(), Cell(std::int64_t{3}));
}

TEST(QuerySandbox, GivesTextsThatCanBePrinted) {
  QuerySandbox sandbox = three_rows();
  EXPECT_EQ(sandbox.run("SELECT x'41ff', 'a' || char(10) || char(27) || char(0) || 'b'", {}).rows.front(),
            (std::vector<Cell>{"A\\xff", "a\\n\\u001b\\u0000b"}));
}

TEST(QuerySandbox, ReadsItsTableAndComputes) {
  QuerySandbox sandbox = three_rows();
  const fs::path file = fs::temp_directory_path() / "marti-query-sandbox";
  const std::string digits = "WITH t(x) AS (VALUES (0),(1),(2),(3),(4),(5),(6),(7),(8),(9)) ";
  const std::string tens = digits + "SELECT count(*) FROM t a, t b, t c, t d, t e, t f, t g, t h, t i, t j";
  std::string unfolding = "WITH a0 AS (SELECT 1)";  // each has two of the one before it
  for (int i = 1; i <= 30; ++i) {
    unfolding += fmt::format(", a{0} AS (SELECT 1 FROM a{1} x, a{1} y)", i, i - 1);
  }
  unfolding += " SELECT count(*) FROM a30";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"DROP TABLE points", "f:1: k: may only read the table points and compute"},
      {"DELETE FROM points", "f:1: k: may only read"},
      {"INSERT INTO points VALUES (1, 2, 3)", "f:1: k: may only read"},
      {"PRAGMA writable_schema = 1", "f:1: k: may only read"},
      {"ATTACH '" + file.string() + "' AS other", "f:1: k: may only read"},
      {"SELECT * FROM sqlite_schema", "f:1: k: may only read"},
      {"SELECT * FROM pragma_database_list", "f:1: k: "},
      {"SELECT load_extension('x')", "f:1: k: "},
      {"SELECT random()", "f:1: k: may only read"},
      {"SELECT CURRENT_TIMESTAMP", "f:1: k: may only read"},
      {"SELECT unixepoch()", "f:1: k: "},
      {"SELECT * FROM sqlite_temp_schema", "f:1: k: may only read"},
      {"EXPLAIN SELECT 1", "f:1: k: is no SELECT"},
      {"EXPLAIN QUERY PLAN SELECT 1", "f:1: k: is no SELECT"},
      {"SELECT datetime('now')", "f:1: k: may only read"},
      {"SELECT zeroblob(1000000000)", "f:1: k: "},
      {"SELECT replace(printf('%1000d', 1), ' ', printf('%10000d', 1))", "f:1: k: SQLite: "},
      {"WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM r) SELECT x FROM r",
       "f:1: k: may only read"},
      {tens, "f:1: k: takes too long"},
      {digits +
           "SELECT count(*) FROM (SELECT DISTINCT printf('%90000d', a.x + 10 * b.x + 100 * c.x + 1000 * d.x) "
           "FROM t a, t b, t c, t d)",
       "f:1: k: takes more than 256 MB of memory"},
      {unfolding, "f:1: k: takes more than 256 MB of memory"},
      {digits + "SELECT printf('%99999d', 1) FROM t a, t b, t c", "f:1: k: gives more than 10 MB"},
      {"SELECT \"\x1b[31m\"", "f:1: k: SQLite: no such column: \\u001b[31m"},
      {"SELECT 1; SELECT 2", "f:1: k: has more than one statement"},
      {"SELECT ?", "f:1: k: is no SELECT without parameters"},
      {"", "f:1: k: is no SELECT"},
      {"-- nothing", "f:1: k: is no SELECT"},
      {"SELEC 1", "f:1: k: SQLite: near \"SELEC\""},
      {"SELECT \"machine.node\" FROM points", "f:1: k: SQLite: no such column: machine.node"},
      {"SELECT a.end FROM points a, points b, points c, points d, points e, points f, points g, points h, "
       "points i",
       "f:1: k: gives more than 10000 rows"},
      {std::string("SELECT 1\0, 2", 11), "f:1: k: has a character that no query has"}};
  test::expect_messages(cases, [&](const std::string& sql) {
    return user_error_of([&] { (void)sandbox.run(sql, {"f:1: k"}); });
  });
  EXPECT_FALSE(fs::exists(file));
  EXPECT_EQ(sandbox.run("SELECT count(*) FROM points", {}).rows.front().front(), Cell(std::int64_t{3}));
}

sim::Config config_with(const std::string& question) {
  return test::sweep_config("[sweep.axes]\nmachine.nodes = [1, 4]\n" + question);
}

TEST(Question, RefusesWhatItIsNot) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"[question]", "s.toml:3: question.asks: is missing"},
      {"[question]\nanswer = \"SELECT 1\"", "s.toml:3: question.asks: is missing"},
      {"[question]\nasks = \"why?\"", "s.toml:3: question.answer: is missing"},
      {"[question]\nasks = \"why?\"\nanswer = 3",
       "s.toml:5: question.answer: must be a text, not the integer 3"},
      {"[question]\nasks = \"\"\nanswer = \"SELECT 1\"", "s.toml:4: question.asks: must be a text"},
      {"[question]\nasks = \"a\\nb\"\nanswer = \"SELECT 1\"", "s.toml:4: question.asks: must be a line"},
      {"[question]\nasks = \"why?\"\nanswr = \"SELECT 1\"",
       "s.toml:5: question.answr: unknown key (did you mean \"answer\"?)"},
      {"[question]\nasks = \"why?\"\nanswer = \"SELECT 1\"\ntable = 3",
       "s.toml:6: question.table: must be tables, each under"},
      {"[question]\nasks = \"why?\"\nanswer = \"SELECT 1\"\n[[question.table]]\nname = \"A b\"",
       "s.toml:7: question.table.name: must be of lower-case letters"},
      {"[question]\nasks = \"why?\"\nanswer = \"SELECT 1\"\n[[question.claim]]\nsubject = \"s\"",
       "s.toml:6: question.claim.says: is missing"}};
  test::expect_messages(cases, [](const std::string& text) {
    return user_error_of([&] { (void)read_question(config_with(text)); });
  });
  EXPECT_TRUE(read_question(config_with("")).asks.empty());
}

TEST(Question, IsCheckedBeforeAnythingIsTimed) {
  const auto error_of = [](const std::string& rest) {
    return user_error_of([&] {
      check_question(read_question(config_with("[question]\nasks = \"why?\"\n" + rest)),
                     std::vector<std::string>{"machine.nodes"});
    });
  };
  EXPECT_EQ(error_of("answer = \"SELECT min(end), \\\"machine.nodes\\\" FROM points\""), "no UserError");
  EXPECT_EQ(error_of("answer = \"SELECT ends FROM points\""),
            "s.toml:5: question.answer: SQLite: no such column: ends");
  const std::string table =
      "answer = \"SELECT 1\"\n[[question.table]]\nname = \"t\"\ntitle = \"T\"\nsql = \"SELECT ";
  EXPECT_EQ(error_of(table + "end, end FROM points\"").substr(0, 60),
            "s.toml:9: question.table.sql: each column needs a name of it");
  EXPECT_EQ(error_of(table + "end + 1 FROM points\"").substr(0, 60),
            "s.toml:9: question.table.sql: each column needs a name of it");
}

// Three machines of which two are timed; the answer is of these two.
TEST(Question, IsAnsweredFromThePointsThatAreTimed) {
  const test::TemporaryDirectory directory;
  SweepPlan plan = test::made_plan(3);
  plan.question = {
      "Which is fast?",
      {"SELECT printf('%d of them', count(*)) FROM points UNION ALL SELECT NULL",
       "s.toml:5: question.answer"},
      {{"times", "Times", {"SELECT ordinal, end, 2 * end AS twice, 'x' AS word FROM points", "s.toml:8: t"}}},
      {{"all", "there are two", {"SELECT count(*) FROM points", ""}, {"SELECT count(*) = 2 FROM points", ""}},
       {"none", "there are three", {"SELECT NULL", ""}, {"SELECT count(*) = 3 FROM points", ""}},
       {"no", "nobody knows", {"SELECT 1 WHERE 0", ""}, {"SELECT NULL", ""}}}};
  const fs::path file = directory.path() / "results.sqlite";
  {
    SweepStore store(file, plan);
    EXPECT_EQ(answers_of(SweepReader(file)).answer, std::vector<std::string>{"0 of them"});
    store.add_frame(0, test::made_frame_row(0), 1);
    store.add_result(0, test::made_row(0), 1);
    store.add_result(2, test::made_row(2), 1);
  }
  const Answers answers = answers_of(SweepReader(file));
  EXPECT_EQ(answer_text(answers), "question      Which is fast?\nanswer        2 of them\n");
  ASSERT_EQ(answers.tables.size(), 1U);
  const Table& table = answers.tables.front();
  EXPECT_EQ(table.columns()[1].unit, "ps");
  ASSERT_EQ(table.rows().size(), 2U);
  EXPECT_EQ(table.at(1, "ordinal"), Cell(std::int64_t{2}));
  EXPECT_EQ(std::get<std::int64_t>(table.at(1, "twice")), 2 * std::get<std::int64_t>(table.at(1, "end")));
  ASSERT_EQ(answers.claims.size(), 3U);
  EXPECT_EQ(answers.claims[0].here, "2");
  EXPECT_EQ(answers.claims[0].verdict, Verdict::agrees);
  EXPECT_EQ(answers.claims[1].verdict, Verdict::differs);
  EXPECT_EQ(answers.claims[2].verdict, Verdict::not_measured);
  // Whether a claim holds is no text.
  plan.question.claims[2].agrees = {"SELECT 'yes' FROM points", "s.toml:20: question.claim.agrees"};
  { const SweepStore store(file, plan); }
  EXPECT_EQ(user_error_of([&] { (void)answers_of(SweepReader(file)); }),
            "s.toml:20: question.claim.agrees: must give 1, 0 or nothing, not a text");
  // Another question of the same points needs no machine timed again.
  plan.question = {};
  SweepStore store(file, plan);
  EXPECT_EQ(store.done(), (std::vector<bool>{true, false, true}));
  EXPECT_EQ(answer_text(answers_of(SweepReader(file))), "");
}

// Every shipped question gives a sentence, from machines that are timed on very small images.
TEST(Question, OfEveryShippedFileIsOfItsPoints) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(MARTI_SOURCE) / "configs" / "questions")) {
    if (entry.path().extension() == ".toml") {
      ++files;
      sim::Config config = sim::Config::from_file(sweep_schema(), entry.path());
      const SweepPlan plan = plan_sweep(config);
      EXPECT_FALSE(plan.question.asks.empty()) << entry.path();
      EXPECT_EQ(user_error_of([&] { check_question(plan.question, plan.axes); }), "no UserError")
          << entry.path();
    }
  }
  EXPECT_GT(files, 10U);
}

}  // namespace

}  // namespace marti::studies
