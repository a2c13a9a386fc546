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
#include <utility>
#include <vector>

#include "accel/cut_outs.h"
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

/// What a ray meets, as the words of accel/bvh_meets.h.
class RayMeets {
 public:
  virtual ~RayMeets() = default;
  /// Adds the ray's words. Not for several threads at a time.
  virtual void add(const accel::Ray& ray, std::vector<std::uint32_t>& words) = 0;
};

/// Words that a row has beside its steps.
class BesideWords {
 public:
  void begin_row(std::uint32_t width) {
    words_.clear();
    begin_.clear();
    begin_.reserve(std::size_t{width} + 1);
  }
  void begin_pixel() { begin_.push_back(static_cast<std::uint32_t>(words_.size())); }
  [[nodiscard]] std::vector<std::uint32_t>& words() { return words_; }
  /// Copies the row out at its exact size. Throws UserError for more words than offsets can say.
  void end_row(RowWords& row, const sim::ChunkAllocator<std::uint32_t>& chunks) {
    if (words_.size() > std::numeric_limits<std::uint32_t>::max()) {
      throw sim::UserError(
          "what is recorded beside one image row exceeds 2^32 words; lower image.max_depth, image.samples or "
          "the image's width");
    }
    begin_pixel();
    row.words = sim::ChunkVector<std::uint32_t>(words_.begin(), words_.end(), chunks);
    row.begin = sim::ChunkVector<std::uint32_t>(begin_.begin(), begin_.end(), chunks);
  }

 private:
  std::vector<std::uint32_t> words_;
  std::vector<std::uint32_t> begin_;
};

/// Writes one image row at a time, also from walks that ask whether hits count. The words go through a raw
/// pointer into a buffer that the recorder keeps from row to row, because most of recording's cost would be
/// growing and clearing vectors; a finished row is copied out at its exact size.
class RowRecorder : public accel::AnyHitListener {
 public:
  RowRecorder() = default;
  RowRecorder(const RowRecorder&) = delete;
  RowRecorder& operator=(const RowRecorder&) = delete;
  virtual ~RowRecorder() = default;

  void phase(Phase /*phase*/, RayKind /*kind*/) {}

  /// `grid`: by which the row also gets a word for each ray; `meets`: what each ray meets. Null: it gets
  /// none.
  void begin_row(std::uint32_t width, const RayGrid* grid = nullptr, RayMeets* meets = nullptr) {
    next_ = buffer_.get();
    begin_.clear();
    begin_.reserve(std::size_t{width} + 1);
    grid_ = grid;
    rays_.begin_row(width);
    meeting_ = meets;
    meets_.begin_row(width);
  }
  void begin_pixel() {
    end_pixel();
    begin_.push_back(static_cast<std::uint32_t>(next_ - buffer_.get()));
    if (grid_ != nullptr) {
      rays_.begin_pixel();
    }
    if (meeting_ != nullptr) {
      meets_.begin_pixel();
    }
  }

  void branch(std::uint32_t node) { put(make_word(Step::branch, node)); }
  void transform(std::uint32_t node) { put(make_word(Step::transform, node)); }
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
      rays_.words().push_back(grid_->word(ray));
    }
    if (meeting_ != nullptr) {
      meeting_->add(ray, meets_.words());
    }
  }
  void shade(std::uint32_t material) { put(make_word(Step::shade, material)); }
  void light(std::uint32_t light) { put(make_word(Step::light, light)); }
  void texel(std::uint32_t texture, std::uint32_t texel) { put(make_word(Step::texel, texture), texel); }
  void any_hit(const accel::AnyHit& hit) final {
    asked_ = true;
    put(make_word(Step::any_hit, hit.material));
    if (hit.texture != scenes::no_texture) {
      texel(hit.texture, hit.texel);
    }
  }

  /// What a pixel was recorded as before.
  void copy(const LogRow& row, std::uint32_t x) {
    const std::span<const std::uint32_t> words = row.pixel(x);
    if (static_cast<std::size_t>(end_ - next_) < words.size()) {
      grow(words.size());
    }
    next_ = std::copy(words.begin(), words.end(), next_);
    copy_beside(row.rays, x, rays_);
    copy_beside(row.meets, x, meets_);
  }

  /// Ends the row and copies it out.
  void end_row(LogRow& row) {
    end_pixel();
    begin_.push_back(static_cast<std::uint32_t>(next_ - buffer_.get()));
    const sim::ChunkAllocator<std::uint32_t> chunks(chunks_);
    row.words = sim::ChunkVector<std::uint32_t>(buffer_.get(), next_, chunks);
    row.begin = sim::ChunkVector<std::uint32_t>(begin_.begin(), begin_.end(), chunks);
    if (grid_ != nullptr) {
      rays_.end_row(row.rays, chunks);
    }
    if (meeting_ != nullptr) {
      meets_.end_row(row.meets, chunks);
    }
  }

 protected:
  static void copy_beside(const RowWords& row, std::uint32_t x, BesideWords& beside) {
    if (!row.begin.empty()) {
      const std::span<const std::uint32_t> words = row.pixel(x);
      beside.words().insert(beside.words().end(), words.begin(), words.end());
    }
  }

  sim::Chunks chunks_;  // of the rows

 private:
  struct Free {
    void operator()(std::uint32_t* words) const { std::free(words); }
  };

  // Puts each leaf before the hits that were asked about while it was tested: a walk tells of it after them.
  void end_pixel() {
    if (!std::exchange(asked_, false)) [[likely]] {
      return;
    }
    std::uint32_t* word = buffer_.get() + begin_.back();
    while (word != next_) {
      std::uint32_t* leaf = word;
      while (step_of(*leaf) == Step::any_hit) {
        leaf += any_hit_words(leaf);
      }
      std::uint32_t* const end = leaf + step_words(leaf);
      std::rotate(word, leaf, end);
      word = end;
    }
  }

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
  bool asked_ = false;  // in the present pixel, whether a hit counts
  const RayGrid* grid_ = nullptr;
  BesideWords rays_;
  RayMeets* meeting_ = nullptr;
  BesideWords meets_;
};

/// Writes beside the words which children of each branch the rays enter.
class EnteredRecorder : public RowRecorder {
 public:
  void begin_row(std::uint32_t width, const RayGrid* grid = nullptr, RayMeets* meets = nullptr) {
    RowRecorder::begin_row(width, grid, meets);
    entered_.begin_row(width);
  }
  void begin_pixel() {
    RowRecorder::begin_pixel();
    entered_.begin_pixel();
  }
  void entered(accel::EnteredChildren children) { entered_.words().push_back(children.word()); }
  void copy(const LogRow& row, std::uint32_t x) {
    RowRecorder::copy(row, x);
    copy_beside(row.entered, x, entered_);
  }
  void end_row(LogRow& row) {
    RowRecorder::end_row(row);
    entered_.end_row(row.entered, sim::ChunkAllocator<std::uint32_t>(chunks_));
  }

 private:
  BesideWords entered_;
};

}  // namespace marti::processors::program
