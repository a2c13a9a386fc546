// marti as a library: a run, a sweep, and results that were written before, in three calls. What they give is
// what the program `marti` says: the figures of `marti figures`, by name, with their units.
//
// The header needs nothing but the C++ library. All functions throw marti::Error for what is wrong with the
// input, and std::bad_alloc when the computer's memory does not suffice. Results do not depend on the number
// of threads. Different threads may call at the same time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#if defined(__GNUC__)
#define MARTI_PUBLIC __attribute__((visibility("default")))
#else
#define MARTI_PUBLIC
#endif

namespace marti {

/// A fault of the input. what() is the complete message of the program: where it has a place, it begins with
/// "file:line: key: ", and it says what would be right.
class MARTI_PUBLIC Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, std::string file = {}, int line = 0, std::string key = {});
  /// Of the configuration, "defaults" without one; empty where a setting or something else is at fault.
  [[nodiscard]] const std::string& file() const { return file_; }
  /// From 1; 0 where the key has its default, or no file is at fault.
  [[nodiscard]] int line() const { return line_; }
  /// "cache.size", as it was given: also one that does not exist.
  [[nodiscard]] const std::string& key() const { return key_; }

 private:
  std::string file_;
  int line_ = 0;
  std::string key_;
};

/// Thrown in place of a result after `keep_going` has said no.
class MARTI_PUBLIC Interrupted : public std::runtime_error {
 public:
  Interrupted();
};

/// Asked several times a second by the thread that has called, while another one works, until it says no.
using KeepGoing = std::function<bool()>;

/// A cell of a table, or a figure; std::monostate where a machine lacks the figure.
using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

struct Column {
  std::string name;
  std::string unit;     ///< "1" for a number, "fraction" for a part of a whole, "ps", "byte", ...
  std::string meaning;  ///< for people
};

struct Table {
  std::string name;
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<Value>> rows;  ///< each with a value for each column
};

/// Linear RGB, rows from the top, three floats for each pixel.
struct Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<float> rgb;
};

/// What one machine took for one frame: of run(), or of a directory that `marti run -o` has written.
class MARTI_PUBLIC Result {
 public:
  /// A figure of the machine ("end", "hit_ratio", "energy_frame") or, behind "frame.", of the frame
  /// ("frame.camera_rays"). Of both kinds those that count are integers. Throws Error for a name that no
  /// machine has, with the nearest that there is.
  [[nodiscard]] Value figure(std::string_view name) const;
  /// "figures": name, value, unit and meaning of each figure that this machine has.
  [[nodiscard]] const Table& figures() const;
  /// Keys and values of the configuration, as a file has them.
  [[nodiscard]] const std::map<std::string, std::string>& settings() const;
  /// The result for programs, as docs/internals/result-json.md describes it.
  [[nodiscard]] const std::string& json() const;
  /// As `marti run` prints it; of a result that was opened its answer alone.
  [[nodiscard]] const std::string& summary() const;
  /// Throws Error when the image cannot be read, and of a frame from a log (scene.log), which has none.
  [[nodiscard]] Image image() const;
  /// What the rays of image.rays hit, an array of NumPy as docs/scenes.md describes hits.npy. Throws Error
  /// for a result without given rays, or whose file cannot be read.
  [[nodiscard]] std::string ray_hits() const;
  /// The page of `marti report`: one HTML file that loads nothing.
  [[nodiscard]] std::string report() const;
  /// Writes what `marti run -o` writes. Throws Error for a directory that holds another kind of result, and
  /// for a result that is in a directory already.
  void save(const std::string& directory) const;
  /// Where it is; empty for one that is in no directory.
  [[nodiscard]] const std::string& directory() const;

  struct Data;  ///< of the library
  explicit Result(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

 private:
  std::shared_ptr<const Data> data_;
};

/// The points of a sweep() or of a directory that `marti sweep -o` has written.
class MARTI_PUBLIC Sweep {
 public:
  /// "points": a row for each point that has been timed: its axes, its cost, and all figures.
  [[nodiscard]] const Table& points() const;
  /// The names of the axes, which are the first columns of points().
  [[nodiscard]] const std::vector<std::string>& axes() const;
  /// "best": the points that no other beats in cost and in the figure, which may be lower or higher.
  [[nodiscard]] Table best(const std::string& figure, std::optional<double> budget = std::nullopt) const;
  /// The answer to the sweep's question, if it has one, the fastest machine, and what would help it.
  [[nodiscard]] const std::string& summary() const;
  /// The tables of the sweep's question.
  [[nodiscard]] const std::vector<Table>& tables() const;
  [[nodiscard]] std::string report() const;
  [[nodiscard]] const std::string& directory() const;
  /// Whether all points have been timed; not when other shares are still missing.
  [[nodiscard]] bool complete() const;

  struct Data;  ///< of the library
  explicit Sweep(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

 private:
  std::shared_ptr<const Data> data_;
};

/// The tables of a directory that `marti study ... -o` has written.
class MARTI_PUBLIC Study {
 public:
  [[nodiscard]] const std::vector<Table>& tables() const;
  [[nodiscard]] const std::string& summary() const;
  [[nodiscard]] std::string report() const;

  struct Data;  ///< of the library
  explicit Study(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

 private:
  std::shared_ptr<const Data> data_;
};

/// Each "key=value", as after --set: {"machine.nodes=64", "cache.size=16KiB"}.
using Settings = std::vector<std::string>;

/// One frame on one machine. `config`: the name of a TOML file; empty: all keys have their defaults.
/// `directory`: where all is written that `marti run -o` writes, with what the run records; empty: nowhere.
[[nodiscard]] MARTI_PUBLIC Result run(const std::string& config, const Settings& settings = {},
                                      const std::string& directory = {}, const KeepGoing& keep_going = {});

struct SweepChoices {
  /// Where the store is kept, and goes on when it is there already; empty: a directory that is removed with
  /// the last Sweep of it.
  std::string directory{};
  Settings settings{};
  unsigned threads = 0;  ///< machines timed at a time; 0: as many as the computer has
  /// "3/8": only the third of eight parts of the machines, into a directory; empty: all. Of the share that is
  /// not the last to end, the Sweep has no points.
  std::string share{};
};

/// Every machine of the configuration's [sweep] and of these axes, each "key=value,value,...", as after
/// --axis.
[[nodiscard]] MARTI_PUBLIC Sweep sweep(const std::string& config, const std::vector<std::string>& axes,
                                       const SweepChoices& choices = {}, const KeepGoing& keep_going = {});

/// What a command has written into this directory.
[[nodiscard]] MARTI_PUBLIC std::variant<Result, Sweep, Study> open(const std::string& directory);

}  // namespace marti
