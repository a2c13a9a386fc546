// What a run records beside its result, and traces for other cache simulators.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/cli/printed_json.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

TEST(ObserveCommand, ARunRecordsATimelineAndHeatMaps) {
  const TemporaryDirectory directory;
  const Outcome outcome =
      marti("run " + small_run + " --set record.timeline=true --set record.heat_maps=true -o " +
            quoted(directory.path() / "out"));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (const char* line :
       {"lost speed-up", "extra misses", "bounds ", "predicted ", "heat map ", "timeline "}) {
    EXPECT_TRUE(says(outcome, line)) << line;
  }
  for (const char* name :
       {"timeline.json", "heat.exr", "heat-cycles.png", "heat-misses.png", "heat-waits.png"}) {
    EXPECT_TRUE(fs::exists(directory.path() / "out" / name)) << name;
  }
  const auto timeline = nlohmann::json::parse(read(directory.path() / "out" / "timeline.json"));
  EXPECT_GT(timeline["traceEvents"].size(), 100U);
  const auto result = nlohmann::json::parse(read(directory.path() / "out" / "result.json"));
  const auto& figures = result["figures"]["machine"];
  double lost = 0.0;
  for (const char* part : {"extra_misses", "contention", "imbalance", "overhead", "idle"}) {
    lost += figures["lost_" + std::string(part)].get<double>();
  }
  EXPECT_NEAR(lost, 16.0 - figures["speed_up"].get<double>(), 1e-9);
  const auto& bounds = result["machine"]["bounds"];
  EXPECT_LE(bounds["frame_time_at_least_ps"], figures["end"]);
  EXPECT_GT(bounds["prediction"]["mean_value_ps"], 0.0);
}

TEST(ObserveCommand, RecordingChangesNoResultAndNeedsADirectory) {
  const TemporaryDirectory directory;
  const fs::path plain = directory.path() / "plain";
  const fs::path watched = directory.path() / "watched";
  ASSERT_EQ(marti("run " + small_run + " -o " + quoted(plain)).status, 0);
  ASSERT_EQ(marti("run " + small_run + " --set record.heat_maps=true -o " + quoted(watched)).status, 0);
  auto a = nlohmann::json::parse(read(plain / "result.json"));
  auto b = nlohmann::json::parse(read(watched / "result.json"));
  EXPECT_EQ(a["machine"], b["machine"]);
  EXPECT_EQ(a["figures"], b["figures"]);
  for (const char* key : {"record.timeline", "record.heat_maps"}) {
    expect_refused("run " + small_run + " --set " + key + "=true", "which `marti run` has with -o");
  }
  expect_refused("run " + small_run + " --set record.timeline_events=5 -o " + quoted(plain),
                 "record.timeline = false");
  expect_refused("run " + small_run + " --set record.heat_maps=true --set image.width=32768" +
                     " --set image.height=32768 -o " + quoted(plain),
                 "maps of this image take about 64 GiB");
  expect_refused("run " + small_run +
                     " --set record.timeline=true --set record.timeline_from=2ms"
                     " --set record.timeline_to=1ms -o " +
                     quoted(plain),
                 "must lie before");
}

TEST(ObserveCommand, ACriticalPathAddsUpToTheFrameAndChangesNothingElse) {
  const std::string on = " --set record.critical_path=true";
  const auto of_config = [](const std::string& name) { return shipped(name) + small_teapot; };
  for (const std::string& machine : {small_run, of_config("pipeline.toml"), of_config("space.toml")}) {
    const nlohmann::json a = printed_json("run " + machine);
    nlohmann::json b = printed_json("run " + machine + on);
    const nlohmann::json found = b["machine"]["critical_path"];
    std::vector<std::string> divisions = {"time_ps", "nodes_ps"};
    if (found["stages_ps"].is_array()) {
      divisions.emplace_back("stages_ps");
    }
    EXPECT_EQ(divisions.size() == 3, machine.find("pipeline.toml") != std::string::npos);
    for (const std::string& parts : divisions) {
      std::int64_t sum = 0;
      for (const auto& part : found[parts]) {
        sum += part.get<std::int64_t>();
      }
      EXPECT_EQ(sum, b["figures"]["machine"]["end"]) << parts << machine;
    }
    b["machine"].erase("critical_path");
    b["config"] = a["config"];
    EXPECT_EQ(a, b) << machine;
  }
  const Outcome summary = marti("run " + small_run + on);
  EXPECT_EQ(summary.status, 0) << summary.output;
  EXPECT_TRUE(says(summary, "critical path "));
  expect_refused("run " + small_run + on + " --within 2%", "record.critical_path");
}

struct Counts {
  std::int64_t hits = 0;
  std::int64_t misses = 0;
  std::int64_t writes = 0;
};

// Simulates one LRU cache on a din file: labels 0 and 1, four bytes from a multiple of four
// on; writes go past the cache.
Counts simulate(const fs::path& file, std::uint64_t size, std::uint64_t line, std::uint64_t ways) {
  std::map<std::uint64_t, std::vector<std::uint64_t>> sets;
  Counts counts;
  std::ifstream in(file);
  for (std::string text; std::getline(in, text);) {
    const char label = text.at(0);
    const std::uint64_t number = (std::stoull(text.substr(2), nullptr, 16) & ~std::uint64_t{3}) / line;
    if (label == '1') {
      ++counts.writes;
      continue;
    }
    EXPECT_EQ(label, '0');
    std::vector<std::uint64_t>& set = sets[number % (size / line / ways)];
    const auto at = std::find(set.begin(), set.end(), number);
    ++(at != set.end() ? counts.hits : counts.misses);
    if (at != set.end()) {
      set.erase(at);
    } else if (set.size() == ways) {
      set.erase(set.begin());
    }
    set.push_back(number);
  }
  return counts;
}

TEST(TraceCommand, GivesAnotherSimulatorTheHitsAndMissesOfEachNode) {
  const TemporaryDirectory directory;
  const std::string options = small_run + " --set machine.nodes=3 --set cache.size=2KiB --set cache.ways=2";
  const nlohmann::json nodes = printed_json("run " + options)["machine"]["per_node"];
  const Outcome trace = marti("trace " + options + " --format din -o " + quoted(directory.path()));
  ASSERT_EQ(trace.status, 0) << trace.output;
  ASSERT_EQ(nodes.size(), 3U);
  for (std::size_t node = 0; node < 3; ++node) {
    const fs::path file = directory.path() / ("node-0000" + std::to_string(node) + ".din");
    const Counts counts = simulate(file, 2048, 32, 2);
    EXPECT_EQ(counts.hits, nodes[node]["hits"]);
    EXPECT_EQ(counts.misses, nodes[node]["misses"]);
    EXPECT_EQ(counts.writes, nodes[node]["writes"]);
    EXPECT_GT(counts.misses, 0);
  }
}

// What nodes ask of the memory, as an independent reader of each format finds it.
struct Asked {
  std::int64_t reads = 0;
  std::int64_t writes = 0;
  std::int64_t bytes = 0;
  std::uint64_t last = 0;  // time or cycle
  std::uint64_t sum = 0;   // of the addresses
  bool in_order = true;

  void add(bool write, std::uint64_t address, std::int64_t size, std::uint64_t time) {
    ++(write ? writes : reads);
    bytes += size;
    sum += address;
    in_order = in_order && time >= last;
    last = time;
  }
};

Asked read_lines(const fs::path& file, char separator, int access, int address, int time, int size,
                 int base) {
  Asked asked;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::vector<std::string> words;
    std::istringstream parts(line);
    for (std::string word; std::getline(parts, word, separator);) {
      words.push_back(word);
    }
    const std::string& verb = words.at(static_cast<std::size_t>(access));
    if (verb == "access") {
      continue;  // the header of a CSV file
    }
    const auto number = [&](int column, int of_base) {
      return column < 0 ? 0 : std::stoull(words.at(static_cast<std::size_t>(column)), nullptr, of_base);
    };
    const bool write = verb == "write" || verb == "ST" || verb == "W" || verb == "WRITE";
    EXPECT_TRUE(write || verb == "read" || verb == "LD" || verb == "R" || verb == "READ") << line;
    asked.add(write, number(address, base), static_cast<std::int64_t>(number(size, 10)), number(time, 10));
  }
  return asked;
}

std::uint64_t little_endian(const std::string& bytes, std::size_t at) {
  std::uint64_t number = 0;
  for (std::size_t k = 8; k-- > 0;) {
    number = number << 8U | static_cast<unsigned char>(bytes.at(at + k));
  }
  return number;
}

Asked read_champsim(const std::string& bytes) {
  Asked asked;
  EXPECT_EQ(bytes.size() % 64, 0U);
  for (std::size_t at = 0; at < bytes.size(); at += 64) {
    const std::uint64_t written = little_endian(bytes, at + 16);
    const std::uint64_t address = written != 0 ? written : little_endian(bytes, at + 32);
    asked.add(written != 0, address - (std::uint64_t{1} << 32U), 0, 0);
  }
  return asked;
}

// Messages of Protocol Buffers with numbers and texts alone.
Asked read_gem5(const std::string& bytes) {
  Asked asked;
  EXPECT_TRUE(bytes.starts_with("gem5"));
  std::size_t at = 4;
  const auto number = [&] {
    std::uint64_t value = 0;
    for (unsigned shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes.at(at++));
      value |= static_cast<std::uint64_t>(byte & 0x7fU) << shift;
      if (byte < 0x80) {
        return value;
      }
    }
  };
  for (bool header = true; at < bytes.size(); header = false) {
    const std::uint64_t size = number();
    const std::size_t end = at + size;
    std::map<std::uint64_t, std::uint64_t> fields;
    while (at < end) {
      const std::uint64_t tag = number();
      if (tag % 8 == 2) {
        const std::uint64_t length = number();
        at += length;
      } else {
        fields[tag / 8] = number();
      }
    }
    EXPECT_EQ(at, end);
    if (header) {
      EXPECT_EQ(fields[3], 1'000'000'000'000U);
    } else {
      asked.add(fields[2] == 4, fields[3], static_cast<std::int64_t>(fields[4]), fields[1]);
    }
  }
  return asked;
}

TEST(TraceCommand, OtherSimulatorsReadWhatLeavesTheCaches) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "traces";
  const std::string options = small_run +
                              " --set machine.nodes=3 --set cache.size=2KiB --set cache.line=64"
                              " --set memory.model=dram";
  const nlohmann::json figures = printed_json("run " + options)["figures"]["machine"];
  const auto trace = [&](const std::string& format) {
    const Outcome outcome = marti("trace " + options + " --format " + format + " -o " + quoted(out));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
  };
  for (const char* const format :
       {"csv", "ramulator-loadstore", "ramulator-readwrite", "dramsim3", "gem5", "champsim"}) {
    trace(format);
  }
  const Asked csv = read_lines(out / "requests.csv", ',', 2, 4, 0, 5, 10);
  EXPECT_EQ(csv.reads, figures["interconnect_reads"]);
  EXPECT_EQ(csv.writes, figures["interconnect_writes"]);
  EXPECT_EQ(csv.bytes, figures["interconnect_bytes"]);
  EXPECT_TRUE(csv.in_order);
  EXPECT_LE(csv.last, figures["end"]);
  EXPECT_GT(csv.last, 0U);

  const Asked gem5 = read_gem5(read(out / "requests.ptrc"));
  EXPECT_EQ(std::tie(gem5.reads, gem5.writes, gem5.bytes, gem5.sum, gem5.last, gem5.in_order),
            std::tie(csv.reads, csv.writes, csv.bytes, csv.sum, csv.last, csv.in_order));

  Asked champsim;
  for (int node = 0; node < 3; ++node) {
    const Asked of_node = read_champsim(read(out / ("node-0000" + std::to_string(node) + ".champsim")));
    champsim.reads += of_node.reads;
    champsim.writes += of_node.writes;
    champsim.sum += of_node.sum;
  }
  EXPECT_EQ(std::tie(champsim.reads, champsim.writes, champsim.sum),
            std::tie(csv.reads, csv.writes, csv.sum));

  // Lines of 64 bytes are bursts; a pixel written may lie in two.
  const Asked bursts = read_lines(out / "requests-loadstore.trace", ' ', 0, 1, -1, -1, 16);
  const Asked places = read_lines(out / "requests-readwrite.trace", ' ', 0, -1, -1, -1, 10);
  const Asked cycles = read_lines(out / "requests-dramsim3.trace", ' ', 1, 0, 2, -1, 16);
  for (const Asked& each : {bursts, places, cycles}) {
    EXPECT_EQ(each.reads, csv.reads);
    EXPECT_GE(each.writes, csv.writes);
    EXPECT_EQ(each.writes, bursts.writes);
  }
  EXPECT_EQ(bursts.sum, cycles.sum);
  EXPECT_TRUE(cycles.in_order);
  const std::string fields = read(out / "requests-readwrite.trace");
  EXPECT_EQ(std::count(fields.begin(), fields.end(), ','), 5 * (bursts.reads + bursts.writes));

  expect_refused("trace " + small_run + " --format ramulator-readwrite -o " + quoted(directory.path() / "b"),
                 "memory.model");
  expect_refused("trace " + small_run + " --format csv --limit 1KiB -o " + quoted(directory.path() / "b"),
                 "--limit");
  expect_refused("trace " + small_run + " --set machine.nodes=600 --format champsim -o " +
                     quoted(directory.path() / "b"),
                 "at most 512");
  EXPECT_FALSE(fs::exists(directory.path() / "b"));
}

// What nodes refer to, before their caches, and when: of each node the counts of the run, in order, whatever
// the machine is.
TEST(TraceCommand, ReferencesOfAnyNodeHaveTimes) {
  const TemporaryDirectory directory;
  const std::string common = small_run + " --set machine.nodes=3 --set cache.size=2KiB --set cache.line=64";
  int number = 0;
  for (const std::string& more :
       {std::string(), std::string(" --set node.contexts=2"), std::string(" --set machine.scheme=pipeline"),
        std::string(" --set build.sharing=shared"),
        std::string(" --set node.kind=simt --set structure.kind=bvh --set rt.share=warp")}) {
    SCOPED_TRACE(more);
    const fs::path out = directory.path() / std::to_string(number++);
    const nlohmann::json nodes = printed_json("run " + common + more)["machine"]["per_node"];
    for (const char* const format : {"csv", "champsim", "gem5"}) {
      const Outcome trace =
          marti("trace " + common + more + " --references --format " + format + " -o " + quoted(out));
      ASSERT_EQ(trace.status, 0) << trace.output;
    }
    ASSERT_EQ(nodes.size(), 3U);
    for (std::size_t node = 0; node < 3; ++node) {
      const fs::path file = out / ("references-0000" + std::to_string(node));
      const Asked csv = read_lines(file.string() + ".csv", ',', 2, 4, 0, 5, 10);
      EXPECT_EQ(csv.reads,
                nodes[node]["hits"].get<std::int64_t>() + nodes[node]["misses"].get<std::int64_t>());
      EXPECT_TRUE(csv.in_order);
      const std::string text = read(file.string() + ".csv");
      EXPECT_TRUE(text.starts_with("time_ps,node,access,kind,address,bytes,hit\n"));
      std::int64_t misses = 0;
      for (std::size_t at = text.find(",0\n"); at != std::string::npos; at = text.find(",0\n", at + 1)) {
        ++misses;
      }
      EXPECT_EQ(misses, nodes[node]["misses"]);
      const Asked champsim = read_champsim(read(file.string() + ".champsim"));
      EXPECT_EQ(std::tie(champsim.reads, champsim.writes, champsim.sum),
                std::tie(csv.reads, csv.writes, csv.sum));
      const Asked gem5 = read_gem5(read(file.string() + ".ptrc"));
      EXPECT_EQ(std::tie(gem5.reads, gem5.writes, gem5.bytes, gem5.sum, gem5.last),
                std::tie(csv.reads, csv.writes, csv.bytes, csv.sum, csv.last));
    }
  }
}

// A memory by itself reads what `marti trace` writes. Where times count, it does what it did in the run.
TEST(MemoryCommand, ServesTracesOfAllForms) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "traces";
  const std::string machine =
      " --set machine.nodes=3 --set cache.line=64 --set memory.model=dram --set energy.preset=45nm";
  const std::string options = small_run + machine;
  const nlohmann::json run = printed_json("run " + options)["figures"]["machine"];
  for (const char* const format : {"csv", "ramulator-loadstore", "dramsim3", "gem5"}) {
    ASSERT_EQ(marti("trace " + options + " --format " + format + " -o " + quoted(out)).status, 0) << format;
  }
  const auto served = [&](const char* file, const std::string& more = "") {
    return printed_json("memory " + shipped("marti.toml") + " " + quoted(out / file) + machine + more);
  };
  const nlohmann::json csv = served("requests.csv");
  for (const char* const figure :
       {"interconnect_reads", "interconnect_writes", "interconnect_bytes", "dram_row_hits",
        "dram_row_conflicts", "interconnect_wait_sum", "energy_interconnect", "energy_memory"}) {
    EXPECT_EQ(csv["figures"][figure], run[figure]) << figure;
  }
  EXPECT_EQ(csv["latency"]["waited_for_a_place"], 0);
  for (const char* const file : {"requests-dramsim3.trace", "requests.ptrc"}) {
    const nlohmann::json timed = served(file);
    EXPECT_EQ(timed["figures"]["interconnect_reads"], run["interconnect_reads"]) << file;
    EXPECT_TRUE(timed["trace"]["timed"]) << file;
  }
  const nlohmann::json one = served("requests-loadstore.trace", " --outstanding 1");
  const nlohmann::json many = served("requests-loadstore.trace", " --outstanding 64");
  EXPECT_EQ(one["figures"]["interconnect_reads"], many["figures"]["interconnect_reads"]);
  EXPECT_GT(one["figures"]["end"], many["figures"]["end"]);
  EXPECT_LT(one["latency"]["mean"], many["latency"]["mean"]);
  // Banks serve line by line, also what comes through a pipe.
  std::ofstream(out / "long.csv") << "time_ps,access,address,bytes\n0,read,16,64\n";
  const fs::path pipe = out / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(pipe) << read(out / "long.csv"); });
  const nlohmann::json lines = printed_json("memory " + shipped("marti.toml") + " " + quoted(pipe));
  writer.join();
  EXPECT_EQ(lines["figures"]["interconnect_reads"], 3);
  expect_refused(
      "memory " + shipped("marti.toml") + " " + quoted(out / "long.csv") + " --set machine.clusters=2",
      "machine.clusters");
  const Outcome text = marti("memory " + shipped("marti.toml") + " " + quoted(out / "requests.csv") +
                             " --set machine.nodes=3");
  EXPECT_EQ(text.status, 0) << text.output;
  EXPECT_TRUE(says(text, "answer ")) << text.output;
  EXPECT_TRUE(says(text, "bandwidth ")) << text.output;
}

// References through the caches of their node, whatever the memory behind them is.
TEST(MemoryCommand, HasCachesBeforeItAndAxes) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "references-00000.csv";
  const std::string machine =
      small_run + " --set machine.nodes=1 --set cache.organisation=split --set energy.preset=45nm";
  const nlohmann::json figures = printed_json("run " + machine)["figures"]["machine"];
  ASSERT_EQ(marti("trace " + machine + " --references --format csv -o " + quoted(directory.path())).status,
            0);
  const std::string memory = "memory " + shipped("marti.toml") + " " + quoted(file) +
                             " --set machine.nodes=1 --caches --outstanding 1";
  const nlohmann::json points =
      printed_json(memory +
                   " --set cache.organisation=split --set energy.preset=45nm --axis memory.access_cycles=4,9 "
                   "--axis l2.sharing=none,shared");
  ASSERT_EQ(points.size(), 4U);
  for (const nlohmann::json& point : points) {
    EXPECT_EQ(point["caches"]["hits"], figures["hits"]);
    EXPECT_EQ(point["caches"]["misses"], figures["misses"]);
    EXPECT_EQ(point["figures"]["interconnect_reads"], figures["misses"]);
    EXPECT_EQ(point["figures"]["energy_l1"], figures["energy_l1"]);
    const bool alone = point["settings"]["l2.sharing"] == "none";
    EXPECT_EQ(point["figures"]["energy_memory"] == figures["energy_memory"], alone);
    EXPECT_EQ(point["figures"]["energy_total"],
              point["figures"]["energy_l1"].get<std::int64_t>() +
                  point["figures"]["energy_l2"].get<std::int64_t>() +
                  point["figures"]["energy_interconnect"].get<std::int64_t>() +
                  point["figures"]["energy_memory"].get<std::int64_t>());
  }
  EXPECT_EQ(points[1]["settings"], nlohmann::json({{"memory.access_cycles", "4"}, {"l2.sharing", "shared"}}));
  EXPECT_LT(points[0]["latency"]["mean"], points[2]["latency"]["mean"]);
  const Outcome text = marti(memory + " --axis cache.size=4KiB..16KiB*2");
  EXPECT_EQ(text.status, 0) << text.output;
  EXPECT_TRUE(says(text, "answer        cache.size = 16 KiB: ")) << text.output;
  expect_refused(memory + " --axis cache.size=4KiB --axis cache.size=8KiB", "has an axis already");
  expect_refused(memory + " --axis cache.size=", "--axis");
  expect_refused(memory + " --set cache.organisation=none", "cache.organisation");
  expect_refused("memory " + shipped("marti.toml") + " /dev/zero --axis cache.size=4KiB", "is no file");
  std::ofstream(directory.path() / "plain.trace") << "LD 0\n";
  expect_refused("memory " + shipped("marti.toml") + " " + quoted(directory.path() / "plain.trace") +
                     " --caches --set cache.organisation=split",
                 "the column kind");
}

// What -o writes is what marti report shows: the answer first, and every chart that the memories have.
TEST(MemoryCommand, HasAPage) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  ASSERT_EQ(marti("trace " + small_run + " --format csv -o " + quoted(directory.path())).status, 0);
  const std::string memory = "memory " + shipped("marti.toml") + " " +
                             quoted(directory.path() / "requests.csv") +
                             " --set memory.model=dram --set energy.preset=45nm -o " + quoted(out);
  const Outcome one = marti(memory);
  ASSERT_EQ(one.status, 0) << one.output;
  EXPECT_FALSE(names_in(out).contains("memory_axis.vl.json"));
  const Outcome text = marti(memory + " --axis dram.policy=fcfs,frfcfs");
  ASSERT_EQ(text.status, 0) << text.output;
  for (const char* const name : {"axis", "bandwidth", "energy", "latency", "queue", "rows"}) {
    const nlohmann::json chart =
        nlohmann::json::parse(read(out / (std::string("memory_") + name + ".vl.json")));
    EXPECT_FALSE(chart["data"]["values"].empty()) << name;
  }
  for (const nlohmann::json& row :
       nlohmann::json::parse(read(out / "memory_latency.vl.json"))["data"]["values"]) {
    EXPECT_GE(row["at_most"], row["at_least"]);
    EXPECT_LE(row["share"], 1.0);
  }
  const Outcome report = marti("report " + quoted(out));
  ASSERT_EQ(report.status, 0) << report.output;
  EXPECT_TRUE(says(text, "answer        " + report.output.substr(0, report.output.find('\n'))))
      << text.output;
  expect_refused("run " + small_run + " -o " + quoted(out), "results.sqlite: is there already");
}

TEST(MemoryCommand, SaysWhatIsWrongWithATrace) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "wrong.trace";
  for (const auto& [content, complaint] : std::vector<std::pair<std::string, std::string>>{
           {"", "is empty"},
           {"hello\n", "is no trace of requests"},
           {"0x40 READ 10\n0x40 READ 9\n", "wrong.trace:2: the time is less"},
           {"0x40 READ 10\n0x40 FETCH 12\n", "wrong.trace:2: is not like"},
           {"LD 0x40\nLD\n", "wrong.trace:2: is not like"},
           {"LD 0xffffffffffffffff\n", "is beyond the"},
           {"LD 0x1ffffffffffffffff\n", "is not like"},
           {"0x40 READ 99999999999999999\n", "beyond 2^60"},
           {"time_ps,access\n1,read\n", "is no trace of requests"},
           {"time_ps,access,address\n1,read\n", "wrong.trace:2: address is no number"},
           {"time_ps,access,address\n-1,read,0\n", "wrong.trace:2: time_ps is no number"},
           {"time_ps,node,access,address\n1,16,read,0\n", "beyond machine.nodes"},
           {"time_ps,access,address,bytes\n1,read,0,0\n", "has 0 bytes"},
           {std::string(5000, 'x'), "more than 4,096 bytes"},
           {"gem5\x02\x08", "ends within"},
           // A header of 10^12 ticks a second, then a packet of command 99.
           {"gem5\x07\x18\x80\xa0\x94\xa5\x8d\x1d\x02\x10\x63", "neither gem5's ReadReq"},
       }) {
    std::ofstream(file, std::ios::binary) << content;
    expect_refused("memory " + shipped("marti.toml") + " " + quoted(file), complaint);
  }
  expect_refused("memory " + shipped("marti.toml") + " " + quoted(directory.path()),
                 "no trace that can be read");
  std::ofstream(file) << "LD 0\n";
  expect_refused("memory " + shipped("marti.toml") + " " + quoted(file) + " --set machine.scheme=space",
                 "shared memory");
  expect_refused("memory " + shipped("marti.toml") + " " + quoted(file) + " --outstanding 0",
                 "--outstanding");
}

// The traces beside one another are of one machine, which trace.json names; none of another stays, and none
// of the user's goes.
TEST(TraceCommand, ADirectoryHoldsTheTracesOfOneMachine) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  const auto trace = [&](const std::string& arguments) {
    return "trace " + small_run + " " + arguments + " -o " + quoted(out);
  };
  using Names = std::set<std::string>;
  ASSERT_EQ(marti(trace("--nodes 0-1")).status, 0);
  EXPECT_EQ(names_in(out), (Names{"node-00000.din", "node-00001.din", "trace.json"}));
  const std::string first = read(out / "node-00000.din");
  ASSERT_EQ(marti(trace("--nodes 3 --set host_machine.memory_limit=1GiB")).status, 0);
  EXPECT_EQ(names_in(out), (Names{"node-00000.din", "node-00001.din", "node-00003.din", "trace.json"}));
  EXPECT_EQ(read(out / "node-00000.din"), first);
  auto named = nlohmann::json::parse(read(out / "trace.json"));
  EXPECT_EQ(named["settings"]["machine.scheme"], "\"image\"");
  EXPECT_EQ(named["files"].size(), 3U);
  EXPECT_EQ(named["notes"]["node-00001.din"], "nodes 1");
  ASSERT_EQ(marti(trace("--nodes 0-2,3 --format csv --set machine.nodes=16")).status, 0);
  named = nlohmann::json::parse(read(out / "trace.json"));
  EXPECT_EQ(named["notes"]["requests.csv"], "nodes 0-3");
  ASSERT_EQ(marti(trace("--nodes 2 --set scene.source=tetra:1")).status, 0);
  EXPECT_EQ(names_in(out), (Names{"node-00002.din", "trace.json"}));

  // What trace.json does not name, and what it names and was changed, is the user's.
  const std::string before = read(out / "node-00002.din");
  write(out / "notes.txt", "mine");
  for (const char* name : {"node-00009.din", "node-00002.din"}) {
    write(out / name, "mine");
    expect_refused(trace("--nodes 0"), "is no file that trace.json there says");
    EXPECT_EQ(read(out / name), "mine");
    EXPECT_FALSE(fs::exists(out / "node-00000.din"));
    fs::remove(out / name);
  }
  expect_refused("run " + small_run + " -o " + quoted(out), "trace.json: is there already");
  ASSERT_EQ(marti(trace("--nodes 1")).status, 0);
  EXPECT_EQ(names_in(out), (Names{"node-00001.din", "notes.txt", "trace.json"}));
  const fs::path run = directory.path() / "run";
  ASSERT_EQ(marti("run " + small_run + " -o " + quoted(run)).status, 0);
  expect_refused("trace " + small_run + " -o " + quoted(run), "result.json: is there already");
}

TEST(TraceCommand, SaysWhyItCannotAndLeavesNothing) {
  const TemporaryDirectory directory;
  const std::string out = " -o " + quoted(directory.path() / "out");
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    expect_refused("trace " + arguments + out, why);
    EXPECT_FALSE(fs::exists(directory.path() / "out"));
  };
  refused(small_run + " --limit 1KiB", "more than --limit = 1 KiB");
  refused(small_run + " --limit 5kB", "--limit");
  refused(small_run + " --nodes 3-16", "no node 16");
  refused(small_run + " --nodes \"\"", "at least one node");
  refused(small_run + " --format xml", "xml");
  refused(small_run + " --set machine.nodes=600 --references --format csv", "at most 512");
  const Outcome full =
      shell("trap '' XFSZ; ulimit -f 8; " + quoted(MARTI_PROGRAM) + " trace " + small_run + out);
  EXPECT_EQ(full.status, 2) << full.output;
  EXPECT_TRUE(says(full, "cannot be written"));
  EXPECT_FALSE(fs::exists(directory.path() / "out"));
}

// A timeline and a trace are written while they grow. (A shell lets its background ignore SIGINT.)
TEST(ObserveCommand, InterruptedItLeavesNoFile) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  const std::string config = shipped("marti.toml") + " -o " + quoted(out);
  struct Case {
    const char* command;
    const char* signal;
    int number;
  };
  for (const Case& c :
       {Case{"run --set record.timeline=true --set record.timeline_events=1000000000 ", "TERM", SIGTERM},
        Case{"trace ", "HUP", SIGHUP}}) {
    const std::string grown = "[ -n \"$(find " + quoted(out) + " -size +64k 2>/dev/null)\" ]";
    const Outcome outcome = shell(quoted(MARTI_PROGRAM) + " " + c.command + config + " & i=0; until " +
                                  grown + " || [ $i -ge 600 ]; do sleep 0.05; i=$((i + 1)); done; kill -" +
                                  c.signal + " $!; wait $!; echo status $?");
    EXPECT_TRUE(says(outcome, "status " + std::to_string(128 + c.number))) << c.command;
    EXPECT_TRUE(fs::is_empty(out)) << c.command;
  }
}

TEST(Command, AReaderThatGoesAwayIsNoError) {
  const Outcome outcome =
      shell("( sleep 0.3; " + quoted(MARTI_PROGRAM) + " config; echo status $? >&2 ) | true");
  EXPECT_EQ(outcome.output, "status 0\n");
}

}  // namespace
}  // namespace marti::test
