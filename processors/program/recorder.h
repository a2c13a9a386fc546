// Recorders: what the tracer and the traversals report to. One is compiled into the plain render and does
// nothing, one writes the words of a log row; operation_mix.cpp has a third that counts.
//
// A recorder is an accel visitor (branch, leaf) with the members of NullRecorder.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include "accel/ray.h"
#include "accel/visitor.h"
#include "processors/program/ray_grid.h"
#include "processors/program/work_log.h"
#include "sim/chunks.h"
#include "sim/error.h"

namespace marti::processors::program {

/// Which part of the program runs; the boundaries at which the operation mixes are divided.
enum class Phase : std::uint8_t { ray, shade, texel, light, pixel };

/// The recorder of a plain render: everything inlines to nothing.
struct NullRecorder : accel::NullVisitor {
  /// The work that follows belongs to `phase`; `kind` says which ray when the phase is a ray's set-up.
  void phase(Phase /*phase*/, RayKind /*kind*/) {}
  void begin_pixel() {}
  void ray(RayKind /*kind*/, std::uint32_t /*bounce*/, const accel::Ray& /*ray*/) {}
  void shade(std::uint32_t /*material*/) {}
  void light(std::uint32_t /*light*/) {}
  void texel(std::uint32_t /*texture*/, std::uint32_t /*texel*/) {}
};

/// Writes one image row at a time. The words go through a raw pointer into a buffer that the recorder
/// keeps from row to row, because most of recording's cost would be growing and clearing vectors; a
/// finished row is copied out at its exact size.
class RowRecorder {
 public:
  void phase(Phase /*phase*/, RayKind /*kind*/) {}

  /// `grid`: by which the row also gets a word for each ray; null: it gets none.
  void begin_row(std::uint32_t width, const RayGrid* grid = nullptr) {
    next_ = buffer_.get();
    begin_.clear();
    begin_.reserve(std::size_t{width} + 1);
    grid_ = grid;
    rays_.clear();
    rays_begin_.clear();
  }
  void begin_pixel() {
    begin_.push_back(static_cast<std::uint32_t>(next_ - buffer_.get()));
    if (grid_ != nullptr) {
      rays_begin_.push_back(static_cast<std::uint32_t>(rays_.size()));
    }
  }

  void branch(std::uint32_t node) { put(make_word(Step::branch, node)); }
  void leaf(std::uint32_t node, std::uint32_t tests, std::uint32_t entries) {
    if (tests == entries) [[likely]] {
      put(make_word(Step::leaf, node));
    } else {
      put(make_word(Step::partial_leaf, node), tests);
    }
  }
  void cut(std::uint32_t node) { put(make_word(Step::cut, node)); }
  void pass(std::uint32_t record) { put(make_word(Step::pass, record)); }
  void mailed_leaf(std::uint32_t node, std::uint32_t read, std::uint32_t /*entries*/,
                   const std::uint32_t* tested) {
    put(make_word(Step::mailed_leaf, node), read);
    for (std::uint32_t i = 0; i < mask_words(read); ++i) {
      put(tested[i]);
    }
  }
  void ray(RayKind kind, std::uint32_t bounce, const accel::Ray& ray) {
    put(make_word(Step::ray, ray_operand(kind, bounce)));
    if (grid_ != nullptr) {
      rays_.push_back(grid_->word(ray));
    }
  }
  void shade(std::uint32_t material) { put(make_word(Step::shade, material)); }
  void light(std::uint32_t light) { put(make_word(Step::light, light)); }
  void texel(std::uint32_t texture, std::uint32_t texel) { put(make_word(Step::texel, texture), texel); }

  /// The words of a pixel that was recorded before.
  void copy(std::span<const std::uint32_t> words) {
    if (static_cast<std::size_t>(end_ - next_) < words.size()) {
      grow(words.size());
    }
    next_ = std::copy(words.begin(), words.end(), next_);
  }

  /// What is to go with the words of copy(), where rays have words.
  void copy_rays(std::span<const std::uint32_t> rays) { rays_.insert(rays_.end(), rays.begin(), rays.end()); }

  /// Ends the row and copies it out.
  void end_row(LogRow& row) {
    begin_pixel();
    const sim::ChunkAllocator<std::uint32_t> chunks(chunks_);
    row.words = sim::ChunkVector<std::uint32_t>(buffer_.get(), next_, chunks);
    row.begin = sim::ChunkVector<std::uint32_t>(begin_.begin(), begin_.end(), chunks);
    row.rays = sim::ChunkVector<std::uint32_t>(rays_.begin(), rays_.end(), chunks);
    row.rays_begin = sim::ChunkVector<std::uint32_t>(rays_begin_.begin(), rays_begin_.end(), chunks);
  }

 private:
  struct Free {
    void operator()(std::uint32_t* words) const { std::free(words); }
  };

  void put(std::uint32_t word) {
    if (next_ == end_) [[unlikely]] {
      grow(1);
    }
    *next_++ = word;
  }
  void put(std::uint32_t first, std::uint32_t second) {
    put(first);
    put(second);
  }

  // Makes room for `more` words.
  [[gnu::noinline]] void grow(std::size_t more) {
    const auto used = static_cast<std::size_t>(next_ - buffer_.get());
    const std::size_t capacity = std::max({std::size_t{1} << 16U, 2 * used, used + more});
    if (capacity > std::numeric_limits<std::uint32_t>::max()) {
      throw sim::UserError(
          "the work log of one image row exceeds 2^31 steps; lower image.max_depth, image.samples or the "
          "image's width");
    }
    // realloc and not a vector: the new words need no clearing.
    auto* words = static_cast<std::uint32_t*>(std::realloc(buffer_.get(), capacity * sizeof(std::uint32_t)));
    if (words == nullptr) {
      throw std::bad_alloc();
    }
    static_cast<void>(buffer_.release());
    buffer_.reset(words);
    next_ = words + used;
    end_ = words + capacity;
  }

  std::unique_ptr<std::uint32_t[], Free> buffer_;
  std::uint32_t* next_ = nullptr;
  std::uint32_t* end_ = nullptr;
  std::vector<std::uint32_t> begin_;
  const RayGrid* grid_ = nullptr;
  std::vector<std::uint32_t> rays_;
  std::vector<std::uint32_t> rays_begin_;

 protected:
  sim::Chunks chunks_;  // of the rows
};

/// Writes beside the words which children of each branch the rays enter.
class EnteredRecorder : public RowRecorder {
 public:
  void begin_row(std::uint32_t width, const RayGrid* grid = nullptr) {
    RowRecorder::begin_row(width, grid);
    entered_.clear();
    begin_.clear();
    begin_.reserve(std::size_t{width} + 1);
  }
  void begin_pixel() {
    RowRecorder::begin_pixel();
    begin_.push_back(static_cast<std::uint32_t>(entered_.size()));
  }
  void entered(accel::EnteredChildren children) { entered_.push_back(children.word()); }
  /// What is to go with the words of copy().
  void copy_entered(std::span<const std::uint32_t> words) {
    entered_.insert(entered_.end(), words.begin(), words.end());
  }
  void end_row(LogRow& row) {
    RowRecorder::end_row(row);
    begin_.push_back(static_cast<std::uint32_t>(entered_.size()));
    const sim::ChunkAllocator<std::uint32_t> chunks(chunks_);
    row.entered = sim::ChunkVector<std::uint32_t>(entered_.begin(), entered_.end(), chunks);
    row.entered_begin = sim::ChunkVector<std::uint32_t>(begin_.begin(), begin_.end(), chunks);
  }

 private:
  std::vector<std::uint32_t> entered_;
  std::vector<std::uint32_t> begin_;
};

}  // namespace marti::processors::program
