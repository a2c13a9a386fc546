// A frame of which only samples are traced, and at last perhaps all.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "processors/machine/packets.h"
#include "processors/program/pixel_set.h"
#include "processors/program/render.h"
#include "studies/estimate/packet_windows.h"
#include "studies/run/functional_run.h"
#include "studies/run/prepared_frame.h"

namespace marti::studies::estimate {

/// What was traced of a frame, and what the whole would have been by the pixels of the lattice.
struct TracedPart {
  double pixels = 0.0;     ///< share
  double rays = 0.0;       ///< of the whole frame
  double log_bytes = 0.0;  ///< of the whole frame
};

/// Each pixel is traced at most once.
class SampledFrame {
 public:
  /// Traces the pixels of a set and adds them to a frame that has others already, if that is not null.
  using Trace = std::function<processors::program::Frame(const processors::program::PixelSet& only,
                                                         const processors::program::Frame* before)>;

  SampledFrame(std::uint32_t width, std::uint32_t height, Trace trace);

  [[nodiscard]] const PixelLattice& lattice() const { return lattice_; }
  /// The share of all pixels that would be traced after with(windows).
  [[nodiscard]] double share_with(const PacketWindows& windows) const {
    return static_cast<double>(set_with(&windows).count()) / pixels_;
  }
  /// The log of the lattice and of all that was traced before.
  const processors::program::WorkLog& with_lattice() { return trace(set_with(nullptr)); }
  /// The log of the lattice, of these windows and of all that was traced before.
  const processors::program::WorkLog& with(const PacketWindows& windows) { return trace(set_with(&windows)); }
  /// with() must have been called.
  [[nodiscard]] TracedPart traced() const;
  /// Gives away what is traced. with() must have been called.
  [[nodiscard]] processors::program::Frame part() && { return std::move(*frame_); }
  /// Traces all that is missing, and gives the whole frame away.
  [[nodiscard]] processors::program::Frame whole() &&;

 private:
  // What is traced, with the lattice and, if not null, these windows.
  [[nodiscard]] processors::program::PixelSet set_with(const PacketWindows* windows) const;
  const processors::program::WorkLog& trace(const processors::program::PixelSet& wanted);

  PixelLattice lattice_;
  Trace trace_;
  processors::program::PixelSet traced_;
  double pixels_;
  std::optional<processors::program::Frame> frame_;  // empty before anything is traced
};

/// Of a frame that is ready to be traced; it must outlive what is returned.
[[nodiscard]] SampledFrame sampled_frame(const run::PreparedFrame& prepared);

/// Of a frame that is traced already: takes the pixels from its log. It must outlive what is returned.
[[nodiscard]] SampledFrame sampled_frame(const run::FunctionalRun& traced);

}  // namespace marti::studies::estimate
