#include "studies/compare/result_and_sweep.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/compare/compare_text.h"
#include "studies/compare/differences.h"
#include "studies/sweep/store/sweep_reader.h"

namespace marti::studies::compare {

namespace {

// A timed point and whether it renders the result's frame.
struct Candidate {
  ComparedPoint point;
  bool same_frame = false;
};

// Sets how far the point's settings are from the result's.
void measure(ComparedPoint& point) {
  for (const Difference& setting : point.settings) {
    if (setting.a == tables::Cell() || setting.b == tables::Cell()) {
      continue;
    }
    ++point.distance;
    const std::optional<double> a = setting_number(setting.name, setting.a);
    const std::optional<double> b = setting_number(setting.name, setting.b);
    if (a && b && *a > 0.0 && *b > 0.0) {
      point.doublings += std::abs(std::log2(*a / *b));
    }
  }
}

// The name of a point where the sweep has named ones.
std::string name_of(const sweep::SweepReader& sweep, const sweep::StoredPoint& point) {
  const auto axis = std::ranges::find(sweep.axes(), "point");
  const auto index = static_cast<std::size_t>(axis - sweep.axes().begin());
  const auto* name = index < point.values.size() ? std::get_if<std::string>(&point.values[index]) : nullptr;
  return name == nullptr ? std::string() : *name;
}

std::vector<Candidate> candidates_of(const ComparedResult& own, const sweep::SweepReader& sweep,
                                     ResultAndSweep& found) {
  std::vector<Candidate> candidates;
  const std::vector<std::string> names = {"end"};
  sweep.for_each_point(names, [&](const sweep::StoredPoint& stored, std::span<const tables::Cell> figures) {
    ++found.planned;
    if (!stored.done) {
      return;
    }
    ComparedResult other;
    other.name = sweep.file().string() + ":" + std::to_string(stored.ordinal);
    other.version = sweep.version();
    for (auto& [key, value] : sweep.settings(stored.machine)) {
      other.settings.emplace(key, std::move(value));
    }
    if (const std::optional<sweep::FrameRow> frame = sweep.read_frame(stored.machine)) {
      add_frame(*frame, other);
    }
    other.figures["end"] = figures[0];
    keep_what_sweeps_have(other);
    Candidate& candidate = candidates.emplace_back();
    ComparedPoint& point = candidate.point;
    point.ordinal = stored.ordinal;
    point.name = name_of(sweep, stored);
    point.end = frame_time(other);
    point.ratio = static_cast<double>(found.sweep_is_a() ? found.end : point.end) /
                  static_cast<double>(found.sweep_is_a() ? point.end : found.end);
    candidate.same_frame = same_frame(own, other);
    point.settings = (found.sweep_is_a() ? differences_of(other, own) : differences_of(own, other)).settings;
    measure(point);
  });
  return candidates;
}

// Chooses the points that can be compared; when there are none, all.
void take_points(std::vector<Candidate> candidates, ResultAndSweep& found) {
  found.timed = candidates.size();
  std::map<std::string, Difference> frame;
  for (const Candidate& candidate : candidates) {
    found.same_frame = found.same_frame || candidate.same_frame;
    if (!candidate.same_frame) {
      ++found.other_frames;
      for (const Difference& setting : frame_settings(candidate.point.settings)) {
        frame.emplace(setting.name, setting);
      }
    }
  }
  for (auto& [name, setting] : frame) {
    found.frame.push_back(std::move(setting));
  }
  for (Candidate& candidate : candidates) {
    if (candidate.same_frame || !found.same_frame) {
      found.points.push_back(std::move(candidate.point));
    }
  }
  const bool by_time = found.same_frame;
  std::ranges::stable_sort(found.points, [by_time](const ComparedPoint& x, const ComparedPoint& y) {
    return by_time ? x.end < y.end : is_nearer(x, y);
  });
}

}  // namespace

bool is_nearer(const ComparedPoint& x, const ComparedPoint& y) {
  return std::tie(x.distance, x.doublings, x.ordinal) < std::tie(y.distance, y.doublings, y.ordinal);
}

const ComparedPoint& ResultAndSweep::nearest() const { return *std::ranges::min_element(points, is_nearer); }

ResultAndSweep result_and_sweep(const ComparedResult& result, const std::filesystem::path& file,
                                SweepSide side) {
  const sweep::SweepReader sweep(file);
  ResultAndSweep found;
  found.side = side;
  found.a = found.sweep_is_a() ? file.string() : result.name;
  found.b = found.sweep_is_a() ? result.name : file.string();
  found.end = frame_time(result);
  ComparedResult own = result;
  keep_what_sweeps_have(own);
  take_points(candidates_of(own, sweep, found), found);
  if (found.points.empty()) {
    throw sim::UserError(file.string() +
                         ": no point of this sweep has been run yet; run the sweep again to finish it");
  }
  const std::vector<std::vector<Difference>*> lists =
      sim::mapped(found.points, [&](ComparedPoint& point) { return &point.settings; });
  SharedDifferences shared = take_alike(lists);
  found.alike = std::move(shared.alike);
  found.varied = std::move(shared.varied);
  const auto differ = [&own](const std::vector<Difference>& differences) {
    return static_cast<std::size_t>(std::ranges::count_if(differences, [&own](const Difference& difference) {
      return own.settings.contains(difference.name);
    }));
  };
  found.equal_settings = own.settings.size() - differ(found.alike) - differ(found.varied);
  return found;
}

}  // namespace marti::studies::compare
