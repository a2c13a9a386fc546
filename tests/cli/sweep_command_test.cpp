// `marti sweep` as its user runs it: what it prints, writes and refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/printed_json.h"
#include "tests/cli/sweep_files.h"
#include "tests/support/csv_records.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A directory with a small sweep's configuration in it.
class SweepCommand : public testing::Test {
 protected:
  SweepCommand() { write(config, small_sweep); }
  [[nodiscard]] fs::path place(const std::string& name) const { return directory.path() / name; }

  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "sweep.toml";
  const fs::path out = directory.path() / "out";
  const fs::path store = out / "results.sqlite";
};

// The part of the results that does not depend on the order in which machines were entered.
std::string results_by_key(const fs::path& store) {
  return rows_of(store,
                 "SELECT m.key, r.\"end\", r.events, r.hits, r.misses, r.time_idle FROM results r "
                 "JOIN machines m ON m.id = r.machine ORDER BY m.key");
}

TEST_F(SweepCommand, SaysThePlanTimesAllAndIsDone) {
  const Outcome first = sweep(config, out);
  ASSERT_EQ(first.status, 0) << first.output;
  EXPECT_TRUE(first.output.starts_with("axes          image.max_depth: 1, 2\n")) << first.output;
  EXPECT_TRUE(says(first, "frames        2 functional runs, 0 done\n"));
  EXPECT_TRUE(says(first, "machines      24, 0 done\n"));
  EXPECT_TRUE(says(first, "timed         24 machines on 2 frames in "));
  EXPECT_TRUE(says(first, "wrote         " + store.string()));
  EXPECT_EQ(names_in(out).size(), 2U) << "results.sqlite and points.csv";
  EXPECT_EQ(number_of(store, "SELECT COUNT(*) FROM results"), 24);
  const std::string points = read(out / "points.csv");
  EXPECT_EQ(std::count(points.begin(), points.end(), '\n'), 25);

  const std::string before = dump(store);
  const Outcome again = sweep(config, out);
  ASSERT_EQ(again.status, 0) << again.output;
  EXPECT_TRUE(says(again, "machines      24, 24 done\n"));
  EXPECT_TRUE(says(again, "all of it was there already\n"));
  EXPECT_EQ(dump(store), before);
  EXPECT_EQ(read(out / "points.csv"), points);
}

TEST_F(SweepCommand, TheSameContentAtAnyNumberOfThreadsAndWithLittleMemory) {
  ASSERT_EQ(sweep(config, out).status, 0);
  const std::string expected = dump(store);
  ASSERT_NE(expected.find("integrity: ok"), std::string::npos);
  for (const std::string more : {"--threads 1", "--threads 2", "--threads 4", "--threads 4096",
                                 "--threads 2 --set host_machine.memory_limit=1MiB"}) {
    const TemporaryDirectory other;
    const Outcome outcome = sweep(config, other.path(), more);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(dump(other.path() / "results.sqlite"), expected) << more;
    EXPECT_EQ(read(other.path() / "points.csv"), read(out / "points.csv")) << more;
    EXPECT_EQ(names_in(other.path()).size(), 2U) << more;
  }
}

// The machine that `marti run` takes for a point has the same end, speed-up and counters.
TEST_F(SweepCommand, EachPointIsWhatRunSays) {
  ASSERT_EQ(sweep(config, out).status, 0);
  const json points =
      printed_json("sweep " + quoted(config) + " -o " + quoted(out) + " 2> /dev/null")["rows"];
  ASSERT_EQ(points.size(), 24U);
  std::mt19937_64 random(7);
  for (int i = 0; i < 5; ++i) {
    const json& point = points.at(random() % points.size());
    std::string settings;
    for (const char* key : {"image.max_depth", "machine.nodes", "cache.size", "cache.line"}) {
      settings += std::string(" --set ") + key + "=" + point.at(key).dump();
    }
    // All figures of the run, with equal bits.
    const json result = printed_json("run " + quoted(config) + settings);
    for (const auto& [name, value] : result["figures"]["machine"].items()) {
      EXPECT_EQ(point[name], value) << name << settings;
    }
  }
}

// Who takes the step that the sweep names gets the frame that it promises, with a bus and with DRAM.
TEST_F(SweepCommand, AdviceThatIsFollowedComesTrue) {
  for (const char* const memory : {"", " --set memory.model=dram --set interconnect.kind=crossbar"}) {
    const fs::path results = place("followed" + std::string(memory).substr(0, 6));
    const std::string command = "sweep " + quoted(config) + " -o " + quoted(results) + memory;
    const json points = printed_json(command + " 2> /dev/null")["rows"];
    std::size_t followed = 0;
    for (const json& point : points) {
      if (point.at("advice_set").is_null()) {
        continue;
      }
      ++followed;
      std::string settings = memory;
      for (const char* key : {"image.max_depth", "machine.nodes", "cache.size", "cache.line"}) {
        settings += std::string(" --set ") + key + "=" + point.at(key).dump();
      }
      const auto end_with = [&](const std::string& more) {
        return printed_json("run --no-what-helps " + quoted(config) + settings +
                            more)["figures"]["machine"]["end"]
            .get<double>();
      };
      std::string step;
      std::istringstream each(point["advice_set"].get<std::string>());
      for (std::string setting; std::getline(each >> std::ws, setting, ';');) {
        step += " --set '" + setting + "'";
      }
      EXPECT_DOUBLE_EQ(end_with(step), std::round(end_with("") * (1.0 - point["advice_saves"].get<double>())))
          << settings << step;
      EXPECT_GT(point["advice_saves"], 0.0);
    }
    EXPECT_GE(followed, 2U);
    // The fastest is among them, and the summary says what helps it.
    const Outcome summary = marti(command + " --quiet");
    EXPECT_TRUE(says(summary, "\nfastest       "));
    const auto fastest =
        std::ranges::min_element(points, {}, [](const json& point) { return point.at("end").get<double>(); });
    EXPECT_TRUE(says(summary, "\nwhat helps    " + fastest->at("advice").get<std::string>() + "\n"));
  }
}

TEST_F(SweepCommand, PointsAsCsvAreThoseOfJson) {
  ASSERT_EQ(sweep(config, out).status, 0);
  const json points = printed_json("sweep " + quoted(config) + " -o " + quoted(out) + " 2> /dev/null");
  const std::vector<CsvRecord> csv = read_csv(read(out / "points.csv")).value();
  const CsvRecord& names = csv.at(0);
  ASSERT_EQ(names.size(), points["columns"].size());
  ASSERT_EQ(csv.size(), points["rows"].size() + 1);
  for (std::size_t k = 1; k < csv.size(); ++k) {
    const CsvRecord& row = csv[k];
    const json& point = points["rows"][k - 1];
    ASSERT_EQ(row.size(), names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
      const json value = point.value(names[i], json());  // fields without a value are missing
      if (value.is_null()) {
        EXPECT_EQ(row[i], "") << names[i];
      } else if (value.is_string()) {
        EXPECT_EQ(row[i], value.get<std::string>()) << names[i];
      } else {
        EXPECT_EQ(std::stod(row[i]), value.get<double>()) << names[i];
      }
    }
  }
}

TEST_F(SweepCommand, AChangedConfigurationAddsPointsAndKeepsResults) {
  ASSERT_EQ(sweep(config, out).status, 0);
  const std::string old_results = results_by_key(store);
  std::string more = small_sweep;
  more.replace(more.find("[1, 2, 4]"), 9, "[1, 2, 3]");
  write(config, more);
  const Outcome outcome = sweep(config, out);
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome, "machines      24, 16 done\n"));
  EXPECT_TRUE(says(outcome, "timed         8 machines on 2 frames"));
  EXPECT_EQ(number_of(store, "SELECT COUNT(*) FROM results"), 32);
  EXPECT_EQ(number_of(store, "SELECT COUNT(*) FROM points WHERE \"machine.nodes\" = 4"), 0);
  EXPECT_EQ(number_of(store, "SELECT COUNT(*) FROM host_machines WHERE session = 2"), 8);
  // The new machines have the results of a separate sweep.
  const fs::path fresh = place("fresh");
  ASSERT_EQ(sweep(config, fresh).status, 0);
  const std::string all = results_by_key(store);
  for (const std::string& part : {old_results, results_by_key(fresh / "results.sqlite")}) {
    std::istringstream lines(part);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_NE(all.find(line), std::string::npos) << line;
    }
  }
  // Back to the first configuration: nothing is left to do.
  write(config, small_sweep);
  EXPECT_TRUE(says(sweep(config, out), "all of it was there already")) << outcome.output;
}

TEST_F(SweepCommand, ThePlanAloneWritesNothing) {
  const Outcome outcome = marti("sweep " + quoted(config) + " --plan");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome, "machines      24"));
  EXPECT_EQ(marti("sweep " + quoted(config) + " --plan -o " + quoted(out)).status, 0);
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(names_in(directory.path()).size(), 1U);
  // --plan knows which machines are done, of this plan and of another.
  ASSERT_EQ(sweep(config, out).status, 0);
  const std::string before = read(store);
  const Outcome all = sweep(config, out, "--plan");
  EXPECT_TRUE(says(all, "frames        2 functional runs, 2 done\nmachines      24, 24 done\n"));
  std::string other = small_sweep;
  other.replace(other.find("[1, 2, 4]"), 9, "[1, 8]");
  write(config, other);
  const Outcome some = sweep(config, out, "--plan");
  EXPECT_TRUE(says(some, "machines      16, 8 done\n"));
  EXPECT_TRUE(says(some, "\nmemory        about "));
  EXPECT_EQ(read(store), before);
  EXPECT_EQ(names_in(out).size(), 2U);
}

TEST_F(SweepCommand, FindsTheBestMachineForABudget) {
  const Outcome best = sweep(config, out, "--best speed_up --budget 6");
  ASSERT_EQ(best.status, 0) << best.output;
  EXPECT_TRUE(says(best, "best speed_up within 6: "));
  EXPECT_TRUE(says(best, "note: the points have 2 different frames"));
  const json front = json::parse(sweep(config, out, "--best end --json").output);
  const json points = json::parse(sweep(config, out, "--json").output);
  double least = 0.0;
  double last_cost = -1.0;
  for (const json& row : front["rows"]) {
    EXPECT_GT(row["cost"].get<double>(), last_cost);
    last_cost = row["cost"].get<double>();
    least = row["end"].get<double>();
    for (const json& point : points["rows"]) {
      EXPECT_TRUE(point["cost"].get<double>() > last_cost || point["end"].get<double>() >= least) << point;
    }
  }
  for (const json& point : points["rows"]) {
    EXPECT_GE(point["end"].get<double>(), least);
  }
  // The best within the budget is marked.
  std::size_t chosen = 0;
  const json within = json::parse(sweep(config, out, "--best end --budget 6 --json").output);
  for (const json& row : within["rows"]) {
    chosen += row["best"].get<std::size_t>();
    EXPECT_TRUE(row["best"] == 0 || row["cost"].get<double>() <= 6.0);
  }
  EXPECT_EQ(chosen, 1U);
  EXPECT_TRUE(says(sweep(config, out, "--best speed_up --within 6"), "best speed_up within 6: "))
      << "the old name";
  const Outcome dear = sweep(config, out, "--best speed_up --budget 0.5");
  EXPECT_EQ(dear.status, 2);
  EXPECT_TRUE(says(dear, "no point costs at most 0.5; the cheapest that has the figure speed_up costs "));
  const Outcome wrong = sweep(config, place("none"), "--best sped_up");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(says(wrong, "did you mean \"speed_up\"?"));
  EXPECT_FALSE(fs::exists(place("none"))) << "said before anything is done";
  const Outcome one_frame =
      sweep(config, place("one"), "--set 'sweep.filter=image.max_depth = 1' --best end");
  EXPECT_TRUE(says(one_frame, "best end: "));
  EXPECT_FALSE(says(one_frame, "different frames"));
  EXPECT_EQ(sweep(config, out, "--budget 3").status, 2) << "without --best";
  EXPECT_EQ(sweep(config, out, "--best end --budget=-1").status, 2);
  EXPECT_EQ(sweep(config, out, "--best end --within nan").status, 2);
}

TEST_F(SweepCommand, ASceneFileIsPartOfTheFrame) {
  const fs::path scene = place("scene.glb");
  ASSERT_EQ(marti("scene export teapot:2 " + quoted(scene)).status, 0);
  const std::string set = "--set scene.source=" + quoted(scene);
  const Outcome first = sweep(config, out, set);
  ASSERT_EQ(first.status, 0) << first.output;
  const std::string old_results = results_by_key(store);
  EXPECT_TRUE(says(sweep(config, out, set), "all of it was there already"));
  // Another scene under the same name is another frame.
  ASSERT_EQ(marti("scene export teapot:3 " + quoted(scene)).status, 0);
  const Outcome other = sweep(config, out, set);
  ASSERT_EQ(other.status, 0) << other.output;
  EXPECT_TRUE(says(other, "timed         24 machines on 2 frames"));
  EXPECT_EQ(number_of(store, "SELECT COUNT(*) FROM frames"), 4);
  EXPECT_EQ(number_of(store, "SELECT COUNT(*) FROM results"), 48);
  fs::remove(scene);
  const Outcome gone = sweep(config, out, set);
  EXPECT_EQ(gone.status, 2);
  EXPECT_TRUE(says(gone, scene.string()));
}

TEST_F(SweepCommand, HasTheEnergyOfEachPoint) {
  write(config,
        "[scene]\nsource = \"teapot:2\"\n[image]\nwidth = 16\nheight = 16\n[energy]\n"
        "preset = \"22nm\"\nnode_area = 0.5\n[sweep.axes]\nenergy.voltage = [0.5, 1.0, 2.0]\n"
        "energy.leakage_density = [0.0, 100.0]\n");
  const Outcome best = sweep(config, out, "--best energy");
  ASSERT_EQ(best.status, 0) << best.output;
  EXPECT_TRUE(says(best, "energy.voltage = 0.5, energy.leakage_density = 0"));
  // Nothing but what switches and what leaks differs among the points, and each by its axis; beside them are
  // the machines of one node that they are measured against.
  EXPECT_EQ(rows_of(store,
                    "SELECT COUNT(DISTINCT \"end\"), COUNT(DISTINCT energy_memory), "
                    "COUNT(DISTINCT energy_operations), COUNT(DISTINCT energy_leakage), "
                    "COUNT(DISTINCT energy_total), SUM(energy_total - energy_operations - energy_l1 - "
                    "energy_l2 - energy_interconnect - energy_memory - energy_leakage) "
                    "FROM results WHERE nodes = 16"),
            rows_of(store, "SELECT 1, 1, 3, 2, 6, 0"));
  const Outcome huge = sweep(config, out, "--set energy.node_area=10000 --set node.clock=1kHz");
  EXPECT_EQ(huge.status, 2);
  EXPECT_TRUE(says(huge, "sweep.toml:7: energy.preset: the energy of "));
}

TEST_F(SweepCommand, RefusesWhatItCannotDo) {
  expect_refused("sweep " + quoted(config), "-o DIR is missing");
  write(place("file"), "in the way");
  const Outcome blocked = sweep(config, place("file"));
  EXPECT_EQ(blocked.status, 2);
  EXPECT_TRUE(says(blocked, place("file").string()));
  const Outcome one = sweep(fs::path(MARTI_SOURCE) / "configs" / "marti.toml", out);
  EXPECT_EQ(one.status, 2);
  EXPECT_TRUE(says(one, "[sweep.axes], [[sweep.zip]] or [sweep.points.NAME]"));
  EXPECT_EQ(sweep(config, out, "--threads=-1").status, 2);
  EXPECT_EQ(sweep(config, out, "--threads 4097").status, 2);
  EXPECT_EQ(sweep(config, out, "--threads many").status, 2);
  EXPECT_EQ(sweep(config, out, "--keep-logs logs").status, 2);
  EXPECT_EQ(sweep(config, out, "--set cache.sise=1KiB").status, 2);
  EXPECT_EQ(marti("sweep " + quoted(place("none.toml")) + " -o " + quoted(out)).status, 2);
  EXPECT_FALSE(fs::exists(out)) << "none of them came so far";
  // A machine that does not fit in the given memory.
  const Outcome large =
      sweep(config, out, "--set host_machine.memory_limit=1MiB --set machine.clusters=4000");
  EXPECT_EQ(large.status, 2);
  EXPECT_TRUE(says(large, "host_machine.memory_limit = 1 MiB"));
  // A frame that does not: that is found out when it is to be traced.
  const std::string huge =
      "--set host_machine.memory_limit=20MiB --set image.width=4000 --set image.height=4000";
  const Outcome frame = sweep(config, out / "below", huge);
  EXPECT_EQ(frame.status, 2);
  EXPECT_TRUE(says(frame, "0 of 24 machines are saved"));
  EXPECT_FALSE(fs::exists(out)) << "what was made for results that never came is removed";
  ASSERT_EQ(sweep(config, out).status, 0);
  const std::string results = results_by_key(store);
  EXPECT_EQ(sweep(config, out, huge).status, 2);
  EXPECT_EQ(results_by_key(store), results);
  const Outcome closed = shell(quoted(MARTI_PROGRAM) + " sweep " + quoted(config) + " --plan > /dev/full");
  EXPECT_EQ(closed.status, 2) << closed.output;
}

}  // namespace
}  // namespace marti::test
