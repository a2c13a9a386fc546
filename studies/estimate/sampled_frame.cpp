#include "studies/estimate/sampled_frame.h"

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "processors/program/recorder.h"
#include "processors/program/work_log.h"

namespace marti::studies::estimate {

SampledFrame::SampledFrame(std::uint32_t width, std::uint32_t height, Trace trace)
    : lattice_(width, height),
      trace_(std::move(trace)),
      traced_(width, height),
      pixels_(static_cast<double>(width) * height) {}

processors::program::PixelSet SampledFrame::set_with(const PacketWindows* windows) const {
  processors::program::PixelSet set = traced_;
  lattice_.add_to(set);
  if (windows != nullptr) {
    windows->add_to(set);
  }
  return set;
}

TracedPart SampledFrame::traced() const {
  double rays = 0.0;
  double words = 0.0;
  const std::vector<processors::walk::PixelPlace> places = lattice_.pixels();
  for (const processors::walk::PixelPlace& place : places) {
    const std::span<const std::uint32_t> pixel = frame_->log->pixel(place.x, place.y);
    words += static_cast<double>(pixel.size());
    for (std::size_t at = 0; at < pixel.size(); at += processors::program::step_words(&pixel[at])) {
      rays += processors::program::step_of(pixel[at]) == processors::program::Step::ray ? 1.0 : 0.0;
    }
  }
  const double scale = pixels_ / static_cast<double>(places.size());
  return {static_cast<double>(traced_.count()) / pixels_, scale * rays, 4.0 * (scale * words + pixels_)};
}

processors::program::Frame SampledFrame::whole() && {
  processors::program::PixelSet all(traced_.width(), traced_.height());
  all.add_all();
  trace(all);
  return std::move(*frame_);
}

const processors::program::WorkLog& SampledFrame::trace(const processors::program::PixelSet& wanted) {
  processors::program::PixelSet missing = wanted;
  missing.remove(traced_);
  if (!frame_ || missing.count() != 0) {
    frame_ = trace_(missing, frame_ ? &*frame_ : nullptr);
    traced_ = wanted;
  }
  return *frame_->log;
}

SampledFrame sampled_frame(const run::PreparedFrame& prepared) {
  const processors::program::RenderOptions& render = prepared.config().render;
  return {render.width, render.height,
          [&prepared](const processors::program::PixelSet& only, const processors::program::Frame* before) {
            return prepared.trace(&only, before);
          }};
}

namespace {

// The pixels of `only`, and those that `before` has.
processors::program::WorkLog part_of(const processors::program::WorkLog& whole,
                                     const processors::program::PixelSet& only,
                                     const processors::program::WorkLog* before) {
  const processors::program::LogFacts& facts = whole;
  processors::program::WorkLog part{facts, {}};
  part.rows.resize(whole.height);
  processors::program::RowRecorder recorder;
  for (std::uint32_t y = 0; y < whole.height; ++y) {
    recorder.begin_row(whole.width);
    for (std::uint32_t x = 0; x < whole.width; ++x) {
      recorder.begin_pixel();
      if (const processors::program::WorkLog* const from = only.has(x, y) ? &whole : before) {
        recorder.copy(from->rows[y], x);
      }
    }
    recorder.end_row(part.rows[y]);
  }
  return part;
}

}  // namespace

SampledFrame sampled_frame(const run::FunctionalRun& traced) {
  const processors::program::WorkLog& whole = *traced.frame.log;
  return {
      whole.width, whole.height,
      [&traced, &whole](const processors::program::PixelSet& only, const processors::program::Frame* before) {
        processors::program::Frame frame = traced.frame;
        frame.log = std::make_shared<const processors::program::WorkLog>(
            part_of(whole, only, before == nullptr ? nullptr : before->log.get()));
        return frame;
      }};
}

}  // namespace marti::studies::estimate
