// How soon `marti explore` answers: the model's figure of a machine, the exact answer, and what would help
// it, by number of nodes and by cache; and how far off the model is. Each machine is asked for as a control's
// move asks: the frame is rendered, other machines were timed before, and nothing is kept of this one.
//   bench_explore [SIZE [REPEATS [CONFIG]]]     default: 256 7 configs/marti.toml
// SIZE: of the square image.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/report.h"
#include "studies/explore/session.h"

namespace {

using namespace marti;

struct Timed {
  nlohmann::json answer;
  double milliseconds = 0.0;
};

template <class Ask>
Timed timed(const Ask& ask) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string answer = ask();
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
  nlohmann::json json = nlohmann::json::parse(answer);
  if (json.contains("error")) {
    throw sim::UserError(answer);
  }
  return {std::move(json), took.count()};
}

// By nearest rank.
double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(1, rank) - 1];
}

// Times of another cache take the place of what is kept of the machine before.
void forget(const studies::explore::Session& session) {
  for (const char* line : {"128 B", "64 B"}) {
    (void)session.answer({{"cache.line", line}, {"cache.size", "64 KiB"}}, studies::helps::Measuring::none);
  }
}

void run(bench::Report& report, const char* size, int repeats, const char* file) {
  const studies::explore::Session session(
      file, {std::string("image.width=") + size, std::string("image.height=") + size});
  std::printf("%s, %s x %s pixels, ms: median, 95 %% of %d\n", file, size, size, repeats);
  std::printf("%6s %7s %-14s %17s %17s %17s %10s\n", "nodes", "cache", "", "model", "answer", "what helps",
              "model off");
  for (const char* nodes : {"16", "64", "256", "1024"}) {
    for (const char* cache : {"1 KiB", "2 KiB", "16 KiB"}) {
      for (const bool fifo : {false, true}) {
        const studies::explore::Settings settings = {{"machine.nodes", nodes},
                                                     {"cache.size", cache},
                                                     {"cache.line", "32 B"},
                                                     {"cache.ways", fifo ? "4" : "1"},
                                                     {"cache.replacement", fifo ? "fifo" : "lru"}};
        const char* const kind = fifo ? "4-way fifo" : "direct-mapped";
        std::vector<double> models;
        std::vector<double> answers;
        std::vector<double> helps;
        double error = 0.0;
        for (int repeat = 0; repeat < repeats; ++repeat) {
          forget(session);
          const Timed model = timed([&] { return session.modelled(settings); });
          const Timed exact = timed([&] { return session.shown(settings, studies::helps::Measuring::none); });
          const Timed help =
              timed([&] { return session.shown(settings, studies::helps::Measuring::within_budget); });
          models.push_back(model.milliseconds);
          answers.push_back(exact.milliseconds);
          helps.push_back(help.milliseconds);
          error = model.answer["end"].get<double>() /
                      exact.answer["result"]["figures"]["machine"]["end"].get<double>() -
                  1.0;
        }
        std::printf("%6s %7s %-14s", nodes, cache, kind);
        for (const std::vector<double>& times : {models, answers, helps}) {
          std::printf(" %8.0f %8.0f", percentile(times, 0.5), percentile(times, 0.95));
        }
        std::printf(" %+8.1f %%\n", 100.0 * error);
        std::fflush(stdout);
        const std::string name = std::string(nodes) + " nodes, " + cache + ", " + kind;
        report.add({.name = name + ": model", .unit = "ms", .ours = percentile(models, 0.5)});
        report.add({.name = name + ": answer", .unit = "ms", .ours = percentile(answers, 0.5)});
        report.add({.name = name + ": what helps", .unit = "ms", .ours = percentile(helps, 0.5)});
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark(
      "bench_explore", argc, argv, [](bench::Report& report, int count, char** values) {
        run(report, count > 1 ? values[1] : "256", std::max(1, count > 2 ? std::atoi(values[2]) : 7),
            count > 3 ? values[3] : "configs/marti.toml");
      });
}
