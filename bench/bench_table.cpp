// Makes one table and one file of the results that several benchmarks have written with --json.
//   bench_table OUTPUT FILE...
//
// OUTPUT is JSON: {"host": {"processor", "cores", "load"}, "benchmarks": [as bench/report.h says]}.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "bench/report.h"
#include "sim/error.h"
#include "sim/files.h"

namespace {

using namespace marti;
using Json = nlohmann::ordered_json;

constexpr std::int64_t most_bytes = std::int64_t{64} << 20U;

// As Linux names it; empty elsewhere.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
      return line.substr(line.find(": ") + 2);
    }
  }
  return {};
}

Json host() {
  // The average of 15 minutes covers the benchmarks and whatever ran beside them.
  std::array<double, 3> load{};
  const int known = getloadavg(load.data(), static_cast<int>(load.size()));
  return {{"processor", processor()},
          {"cores", std::thread::hardware_concurrency()},
          {"load", known == 3 ? Json(load) : Json(nullptr)}};
}

std::string number(const Json& row, const char* name) {
  if (!row.contains(name)) {
    return "";
  }
  const auto value = row[name].get<double>();
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), value < 10.0 ? "%.3f" : "%.1f", value);
  return text.data();
}

std::string aim(const Json& row) {
  if (!row.contains("aim")) {
    return "";
  }
  const bool at_least = row["aim_is"] == "at least";
  const bench::Aim aim{row["aim"].get<double>(), at_least};
  const double figure = row[row.contains("ratio") ? "ratio" : "ours"].get<double>();
  std::array<char, 64> text{};
  (void)std::snprintf(text.data(), text.size(), "%s %g%s", at_least ? ">=" : "<=", aim.value,
                      aim.met(figure) ? "" : "  missed");
  return text.data();
}

void run(int argc, char** argv) {
  if (argc < 3) {
    throw sim::UserError("usage: bench_table OUTPUT FILE...");
  }
  Json benchmarks = Json::array();
  for (int at = 2; at < argc; ++at) {
    try {
      benchmarks.push_back(Json::parse(sim::read_file(argv[at], most_bytes)));
    } catch (const Json::exception& error) {
      throw sim::UserError(std::string(argv[at]) + " is not what a benchmark writes: " + error.what());
    }
  }
  std::printf("%-50s %-11s %10s %10s %-26s %8s  %s\n", "name", "unit", "ours", "peer", "", "ratio", "aim");
  for (const Json& benchmark : benchmarks) {
    std::printf("%s\n", benchmark.at("benchmark").get<std::string>().c_str());
    for (const Json& row : benchmark.at("rows")) {
      std::printf("  %-48s %-11s %10s %10s %-26s %8s  %s\n", row.at("name").get<std::string>().c_str(),
                  row.at("unit").get<std::string>().c_str(), number(row, "ours").c_str(),
                  number(row, "peer").c_str(), row.value("peer_name", std::string()).c_str(),
                  number(row, "ratio").c_str(), aim(row).c_str());
    }
  }
  const Json all = {{"host", host()}, {"benchmarks", benchmarks}};
  sim::write_file(argv[1], all.dump(1) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc, argv);
    return 0;
  } catch (const sim::UserError& error) {
    std::fprintf(stderr, "bench_table: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_table: %s\n", error.what());
    return 1;
  }
}
