#include "studies/compare/compare.h"

#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "sim/error.h"
#include "studies/compare/compare_text.h"
#include "studies/compare/figures.h"
#include "studies/compare/page_parts.h"
#include "studies/compare/result_and_sweep.h"
#include "studies/compare/two_sweeps.h"
#include "studies/compare/verdict.h"
#include "studies/tables/result_directory.h"

namespace marti::studies::compare {

namespace {

namespace fs = std::filesystem;

struct Target {
  enum class Kind : std::uint8_t { run, point, sweep };
  Kind kind = Kind::run;
  fs::path file;
  std::int64_t point = 0;
};

constexpr std::string_view expected =
    "expected is a directory of `marti run`, its result.json, the directory of a sweep, or DIR:N for point N "
    "of a sweep";

Target target_of(const std::string& name) {
  std::error_code ignored;
  if (fs::is_directory(name, ignored)) {
    const fs::path file = tables::results_in(name, expected);
    return {file.extension() == ".json" ? Target::Kind::run : Target::Kind::sweep, file, 0};
  }
  if (tables::is_there(name)) {
    const bool sweep = fs::path(name).extension() == ".sqlite";
    return {sweep ? Target::Kind::sweep : Target::Kind::run, name, 0};
  }
  if (const std::optional<tables::PointName> point = tables::point_named(name)) {
    return {Target::Kind::point, point->store, point->ordinal};
  }
  throw sim::UserError(name + ": there is no such file or directory; " + std::string(expected));
}

ComparedResult read(const Target& target, const std::string& name) {
  return target.kind == Target::Kind::run ? read_run(target.file, name)
                                          : read_point(sweep::SweepReader(target.file), target.point, name);
}

}  // namespace

std::string compare_results(const std::string& a, const std::string& b, const CompareOptions& options,
                            ComparisonPage* page) {
  const Target from = target_of(a);
  const Target to = target_of(b);
  const bool sweep_a = from.kind == Target::Kind::sweep;
  const bool sweep_b = to.kind == Target::Kind::sweep;
  const auto show = [&page](const auto& found) {
    if (page != nullptr) {
      *page = page_of(found);
    }
  };
  if (sweep_a && sweep_b) {
    const TwoSweeps found = two_sweeps(from.file, to.file);
    show(found);
    return options.json ? json_of(found) : text_of(found, options.all);
  }
  if (sweep_a || sweep_b) {
    const ResultAndSweep found = sweep_b ? result_and_sweep(read(from, a), to.file, SweepSide::b)
                                         : result_and_sweep(read(to, b), from.file, SweepSide::a);
    show(found);
    return options.json ? json_of(found) : text_of(found, options.all);
  }
  ComparedResult one = read(from, a);
  ComparedResult other = read(to, b);
  if (from.kind == Target::Kind::point || to.kind == Target::Kind::point) {
    keep_what_sweeps_have(one);
    keep_what_sweeps_have(other);
  }
  const ComparedPair pair = compared_pair(std::move(one), std::move(other));
  show(pair);
  return options.json ? differences_json(pair, options.all) : differences_text(pair, options.all);
}

}  // namespace marti::studies::compare
