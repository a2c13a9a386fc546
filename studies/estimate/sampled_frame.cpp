#include "studies/estimate/sampled_frame.h"

#include <utility>

namespace marti::studies::estimate {

SampledFrame::SampledFrame(std::uint32_t width, std::uint32_t height, Trace trace)
    : lattice_(width, height),
      trace_(std::move(trace)),
      traced_(width, height),
      pixels_(static_cast<double>(width) * height) {}

processors::program::PixelSet SampledFrame::set_with_lattice() const {
  processors::program::PixelSet set = traced_;
  lattice_.add_to(set);
  return set;
}

processors::program::PixelSet SampledFrame::set_with(const PacketWindows& windows) const {
  processors::program::PixelSet set = set_with_lattice();
  windows.add_to(set);
  return set;
}

double SampledFrame::share_with(const PacketWindows& windows) const {
  return static_cast<double>(set_with(windows).count()) / pixels_;
}

TracedPart SampledFrame::traced() const {
  const auto [rays, words] = lattice_.expected_of_image(*frame_->log);
  return {static_cast<double>(traced_.count()) / pixels_, rays, 4.0 * (words + pixels_)};
}

const processors::program::WorkLog& SampledFrame::with_lattice() {
  trace(set_with_lattice());
  return *frame_->log;
}

const processors::program::WorkLog& SampledFrame::with(const PacketWindows& windows) {
  trace(set_with(windows));
  return *frame_->log;
}

processors::program::Frame SampledFrame::whole() && {
  processors::program::PixelSet all(traced_.width(), traced_.height());
  all.add_all();
  trace(all);
  return std::move(*frame_);
}

void SampledFrame::trace(const processors::program::PixelSet& wanted) {
  processors::program::PixelSet missing = wanted;
  missing.remove(traced_);
  if (frame_ && missing.count() == 0) {
    return;
  }
  frame_ = trace_(missing, frame_ ? &*frame_ : nullptr);
  traced_ = wanted;
}

SampledFrame sampled_frame(const run::PreparedFrame& prepared) {
  const processors::program::RenderOptions& render = prepared.config().render;
  return {render.width, render.height,
          [&prepared](const processors::program::PixelSet& only, const processors::program::Frame* before) {
            return prepared.trace(&only, before);
          }};
}

}  // namespace marti::studies::estimate
