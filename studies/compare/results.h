// What `marti compare` reads: a finished result is a list of points.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studies/compare/figures.h"
#include "studies/sweep/store/sweep_reader.h"

namespace marti::studies::compare {

class Results {
 public:
  /// `name` is a directory of `marti run` or its result.json, which make a list of one point; the directory
  /// of a sweep or its store; or "DIR:N", which is point N of that sweep alone. Throws UserError for what
  /// cannot be read, for a point that there is not, and when that one point has not been run yet.
  explicit Results(const std::string& name);

  /// As on the command line; of a sweep the name of its store.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// All points of a sweep, however many these are.
  [[nodiscard]] bool is_sweep() const { return is_sweep_; }
  /// A sweep, or one point of it.
  [[nodiscard]] bool has_store() const { return store_.has_value(); }
  [[nodiscard]] std::string version() const { return store_ ? store_->version() : last_.version; }
  [[nodiscard]] const std::vector<std::string>& axes() const { return axes_; }
  /// In order, timed or not.
  [[nodiscard]] const std::vector<sweep::StoredPoint>& points() const { return points_; }

  /// A point that has been timed, until the next call. Of a sweep without derived figures, and without what
  /// helps it, unless `derived`.
  [[nodiscard]] const ComparedResult& at(const sweep::StoredPoint& point, bool derived);

  /// Keys and values of a point, timed or not. Of a sweep only.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> settings_of(
      const sweep::StoredPoint& point) const {
    return store_->settings(point.machine);
  }

  /// Of a run or a point whose noise is measured its own, of others of a store the largest that it has.
  [[nodiscard]] sweep::Noise noise() const;

  /// Removes from a run what cannot be compared with a sweep: figures that are measured against another
  /// machine, which a run and a sweep do not choose alike, unless `derived` all others that are not counted,
  /// and settings that a sweep does not keep, because no result depends on them.
  void keep_what_sweeps_have(bool derived);

 private:
  std::string name_;
  bool is_sweep_ = false;
  std::optional<sweep::SweepReader> store_;
  std::vector<std::string> axes_;
  std::vector<sweep::StoredPoint> points_;
  ComparedResult last_;                     // the run, or the point that was read last
  std::optional<std::int64_t> last_point_;  // its ordinal
};

}  // namespace marti::studies::compare
