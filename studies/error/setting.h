// A way to an answer, with one setting of its knob: how to get the answer, and what was measured of it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "processors/program/image.h"
#include "sim/work_meter.h"
#include "studies/error/error_keys.h"

namespace marti::studies::error {

/// What is asked for.
inline constexpr std::string_view frame_time = "frame time";
inline constexpr std::string_view image = "image";

struct Answer {
  double ps = 0.0;                   ///< the machine's frame time; unused where an image is asked for
  processors::program::Image image;  ///< empty where the frame time is asked for
  std::string note{};                ///< what else is to be said of it
};

struct Setting {
  std::string_view asked;                             ///< frame_time or image
  std::string way;                                    ///< "--within", "depth": what is turned
  std::string name;                                   ///< the knob's setting
  double value = 0.0;                                 ///< the same as a number
  std::function<Answer(std::uint32_t repeat)> run{};  ///< what is timed
  std::size_t exact = 0;  ///< index of the setting whose answer counts as exact: for that one its own
  bool drawn = false;     ///< each repeat draws samples of its own; else all answers must be equal

  // Measured:
  Answer first{};                 ///< of the first repeat
  double squares = 0.0;           ///< of the relative errors, over all repeats
  double noise = 0.0;             ///< of an exact setting that is drawn: its own relative error
  std::vector<double> seconds{};  ///< of processor time

  /// Relative: of a frame time the size, of an image the root mean square over all pixels and channels,
  /// linear light, over that of the exact image; of drawn images the root mean square over the repeats
  /// (A. Celarek et al., "Quantifying the error of light transport algorithms", CGF 38(4), 2019).
  [[nodiscard]] double error() const;
};

/// Adds an exact run, and the ways to its frame time: `--within`, smaller images, fewer samples, and a bound
/// from a run of one node. A run ends with the figures that a speed-up needs, as that of `marti run` does.
/// `config` must outlive the settings.
void add_frame_ways(const ErrorConfig& config, std::vector<Setting>& settings);

/// Adds the settings of the renderer's knobs, as far as the frame has them, each knob with its exact setting
/// before it: samples, depth, weight, precision and voxel cut. Throws UserError as opening the scene does.
void add_image_knobs(const ErrorConfig& config, std::vector<Setting>& settings);

/// The relative error of an answer.
[[nodiscard]] double error_of(const Answer& answer, const Answer& exact);

/// Runs all settings, `repeats` times, by turns; an exact one comes before those held against it, and one
/// that is drawn is timed once. Throws InternalError when an answer that is not drawn differs from one repeat
/// to the next. `meter`: see run_error().
void measure(std::vector<Setting>& settings, std::uint32_t repeats, sim::WorkMeter* meter);

/// Of an odd or even number of values; throws InternalError for none.
[[nodiscard]] double median(std::vector<double> values);

/// How the errors of settings fall with their values: the exponent p of error = c value^p by least squares of
/// the logarithms, and the half-width of its 95 % interval (infinite for two settings). Settings without
/// error, or with one not above the exact setting's noise, are left out; std::nullopt where fewer than two
/// remain.
struct Exponent {
  double value = 0.0;
  double half_width = 0.0;
  double from = 0.0;  ///< least of the values
  double to = 0.0;    ///< largest
};
[[nodiscard]] std::optional<Exponent> exponent_of(const std::vector<Setting>& settings, std::string_view way);

}  // namespace marti::studies::error
