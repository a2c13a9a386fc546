// The results of a benchmark, for people and for programs: every benchmark takes `--json FILE` beside its own
// arguments and writes its rows there; bench_table makes one table of all files.
//
// {"benchmark": "bench_x", "rows": [{"name": "...", "unit": "M refs/s", "ours": 1.0, "peer_name": "...",
//   "peer": 1.0, "ratio": 1.0, "aim": 1.0, "aim_is": "at least"}]}. Fields may be missing.
#pragma once

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/files.h"

namespace marti::bench {

/// The aim for the ratio, or for the figure itself if there is no ratio.
struct Aim {
  double value = 0.0;
  bool at_least = true;  ///< false: at most

  [[nodiscard]] bool met(double figure) const { return at_least ? figure >= value : figure <= value; }
};

struct Row {
  std::string name;
  std::string unit;
  double ours = 0.0;
  std::string peer_name{};  ///< the program measured beside it, in the same run; empty: none
  double peer = 0.0;        ///< in the same unit
  std::optional<double> ratio{};
  std::optional<Aim> aim{};
};

/// ours / peer.
[[nodiscard]] inline Row against(std::string name, std::string unit, double ours, std::string peer_name,
                                 double peer, std::optional<Aim> aim = std::nullopt) {
  return {std::move(name), std::move(unit), ours, std::move(peer_name), peer, ours / peer, aim};
}

class Report {
 public:
  /// Takes `--json FILE` out of a program's arguments. Throws UserError when the file is missing.
  Report(std::string benchmark, int& argc, char** argv) : benchmark_(std::move(benchmark)) {
    int kept = 1;
    for (int at = 1; at < argc; ++at) {
      if (std::string_view(argv[at]) != "--json") {
        argv[kept++] = argv[at];
      } else if (++at < argc) {
        file_ = argv[at];
      } else {
        throw sim::UserError(benchmark_ + ": --json needs the name of a file");
      }
    }
    argc = kept;
  }

  void add(Row row) { rows_.push_back(std::move(row)); }

  /// Writes the file, if one was asked for.
  void write() const {
    if (file_.empty()) {
      return;
    }
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const Row& row : rows_) {
      nlohmann::ordered_json& object = rows.emplace_back(
          nlohmann::ordered_json{{"name", row.name}, {"unit", row.unit}, {"ours", row.ours}});
      if (!row.peer_name.empty()) {
        object["peer_name"] = row.peer_name;
        object["peer"] = row.peer;
      }
      if (row.ratio) {
        object["ratio"] = *row.ratio;
      }
      if (row.aim) {
        object["aim"] = row.aim->value;
        object["aim_is"] = row.aim->at_least ? "at least" : "at most";
      }
    }
    const nlohmann::ordered_json report = {{"benchmark", benchmark_}, {"rows", rows}};
    sim::write_file(file_, report.dump(1) + "\n");
  }

 private:
  std::string benchmark_;
  std::string file_;
  std::vector<Row> rows_;
};

/// The main() of a benchmark: calls `run` with its report, prints errors, returns the exit status.
template <class Run>
int run_benchmark(const char* name, int argc, char** argv, const Run& run) {
  try {
    Report report(name, argc, argv);
    run(report, argc, argv);
    report.write();
    return 0;
  } catch (const sim::UserError& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: internal error: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace marti::bench
