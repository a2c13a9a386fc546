// A result as comparisons see it, the catalogue's words for its figures, and where the time of two went.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/time.h"
#include "studies/tables/table.h"

namespace marti::studies::compare {

/// By the names of the catalogue (`marti figures`), those of the frame behind "frame."; without those that
/// say how the program worked. A figure is an integer, a real or a text (a hash, the scene's name).
using Figures = std::map<std::string, tables::Cell>;

/// A run, or a point of a sweep.
struct ComparedResult {
  std::string name;                             ///< as on the command line
  std::string version;                          ///< of the program that made it
  std::map<std::string, std::string> settings;  ///< values as in a TOML file
  Figures figures;
  std::string scene_hash;  ///< empty where it is not recorded: a run does not
  std::optional<double>
      noise;          ///< share of its frame time that another order of packets changes, of a run, if known
  std::string helps;  ///< what would make its frame shorter, in a sentence; empty where it is not recorded
};

/// The frame time in ps; 0 when the result has none above 0.
[[nodiscard]] std::int64_t frame_time_if_any(const ComparedResult& result);
/// The frame time in ps. Throws UserError when the result has none above 0.
[[nodiscard]] std::int64_t frame_time(const ComparedResult& result);

/// Whether a figure says something about the machine or frame, not about how the program worked. One that the
/// catalogue does not have is compared, too.
[[nodiscard]] bool is_compared(std::string_view name);
/// The unit of a figure by the catalogue; empty for a text and for a figure that it does not have.
[[nodiscard]] std::string unit_of_figure(std::string_view name);
/// What the catalogue says of it.
[[nodiscard]] std::string meaning_of_figure(std::string_view name);

/// The time of two machines' nodes in one activity; of several pairs of machines the means over the pairs.
struct ActivityTime {
  std::string activity;
  sim::Sum a = 0;         ///< of all nodes of A, ps; of several pairs their sum
  sim::Sum b = 0;         ///< of all nodes of B
  double mean_a = 0.0;    ///< of a node, ps
  double mean_b = 0.0;    ///< of a node, ps
  double change = 0.0;    ///< mean_b - mean_a
  double of_frame = 0.0;  ///< the change by the frame time of A: of all activities together B / A - 1
};

/// Adds up where the time of pairs of machines went.
class ActivityTimes {
 public:
  /// Nothing when a result lacks the times, the number of its nodes or a frame time, or when the times' sum
  /// is not the nodes' frame times: somebody has changed the file.
  void add(const ComparedResult& a, const ComparedResult& b);

  /// The largest part of the frame first, then by the order of the activities. Activities in which nobody
  /// spends time are left out. Empty when nothing was added.
  [[nodiscard]] std::vector<ActivityTime> means() const;

 private:
  std::vector<ActivityTime> sums_;  // of all activities, once a pair has been added
  double pairs_ = 0.0;
};

}  // namespace marti::studies::compare
