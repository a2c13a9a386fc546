#include "studies/estimate/sampled_frame.h"

#include <utility>

namespace marti::studies {

SampledFrame::SampledFrame(std::uint32_t width, std::uint32_t height, Trace trace)
    : lattice_(width, height),
      trace_(std::move(trace)),
      traced_(width, height),
      pixels_(static_cast<double>(width) * height) {}

processors::PixelSet SampledFrame::set_with(const PacketWindows& windows) const {
  processors::PixelSet set = traced_;
  lattice_.add_to(set);
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

const processors::WorkLog& SampledFrame::with(const PacketWindows& windows) {
  trace(set_with(windows));
  return *frame_->log;
}

processors::Frame SampledFrame::whole() && {
  processors::PixelSet all(traced_.width(), traced_.height());
  all.add_all();
  trace(all);
  return std::move(*frame_);
}

void SampledFrame::trace(const processors::PixelSet& wanted) {
  processors::PixelSet missing = wanted;
  missing.remove(traced_);
  if (frame_ && missing.count() == 0) {
    return;
  }
  frame_ = trace_(missing, frame_ ? &*frame_ : nullptr);
  traced_ = wanted;
}

SampledFrame sampled_frame(const PreparedFrame& prepared) {
  const processors::RenderOptions& render = prepared.config().render;
  return {render.width, render.height,
          [&prepared](const processors::PixelSet& only, const processors::Frame* before) {
            return prepared.trace(&only, before);
          }};
}

}  // namespace marti::studies
