#include "memory/recency_tree.h"

#include <algorithm>
#include <bit>

#include "sim/error.h"

namespace marti::memory {

namespace {

constexpr std::uint32_t first_stamps = 1U << 13U;
constexpr std::uint32_t most_stamps = 1U << 30U;
// Restamping adds to each use the time of stamping 1 / (stamps_a_line - 1) lines.
constexpr std::uint32_t stamps_a_line = 4;

}  // namespace

RecencyTree::RecencyTree() { size_for(first_stamps); }

void RecencyTree::add_page(std::size_t page) {
  if (page >= pages_.size()) {
    pages_.resize(std::max(page + 1, 2 * pages_.size()));
  }
  pages_[page] = std::make_unique<Page>();
}

void RecencyTree::begin_word() {
  if (next_ == stamps_) {
    stamp_anew();
    if (next_ % 64 != 0) {
      return;
    }
  }
  const std::uint32_t index = next_ >> block_bits;
  if (next_ % (1U << block_bits) == 0 && index > 0) {
    const std::uint32_t bits = bits_of(here_[index - 1]);
    for (std::uint32_t at = index - 1; std::vector<std::uint32_t> & counts : blocks_) {
      counts[at] += bits;
      at >>= group_bits;
    }
  }
  Block& block = here_[index];
  const std::uint32_t word = (next_ >> word_bits) % 16;
  block.words[word] = ~std::uint64_t{0};
  block.of_words[word / 4] += 64 * lane(word);
  block.of_fours += 64 * lane(word / 4);
}

std::uint32_t RecencyTree::leave_block(std::uint32_t block, std::uint32_t now) {
  std::uint32_t behind = bits_of(here_[now]);
  for (std::vector<std::uint32_t>& counts : blocks_) {
    const std::uint32_t end = std::min(block | (group - 1), now);
    for (std::uint32_t i = block + 1; i <= end; ++i) {
      behind += counts[i];
    }
    --counts[block];
    block >>= group_bits;
    now >>= group_bits;
  }
  return behind;
}

void RecencyTree::size_for(std::uint32_t stamps) {
  stamps_ = stamps;
  line_of_.resize(stamps);
  std::uint32_t size = stamps >> block_bits;
  here_.assign(size, {});
  blocks_.clear();
  do {
    blocks_.emplace_back(size);
    size = (size + group - 1) >> group_bits;
  } while (blocks_.back().size() > group);
}

template <class Use>
void RecencyTree::for_each_here(const Use& use) const {
  for (std::uint32_t first = 0; first < next_; first += 64) {
    std::uint64_t bits = here_[first >> block_bits].words[(first >> word_bits) % 16];
    if (next_ - first < 64) {
      bits &= (std::uint64_t{1} << (next_ - first)) - 1;
    }
    for (; bits != 0; bits &= bits - 1) {
      use(line_of_[first + static_cast<std::uint32_t>(std::countr_zero(bits))]);
    }
  }
}

void RecencyTree::stamp_anew() {
  std::vector<std::uint32_t> lines;
  lines.reserve(lines_);
  for_each_here([&](std::uint32_t line) {
    lines.push_back(line);
    stamp_of(line) = 0;
  });
  std::uint32_t stamps = stamps_;
  while (lines_ > stamps / stamps_a_line) {
    sim::ensure(stamps < most_stamps, "so many lines fit into no host's memory");
    stamps *= 2;
  }
  size_for(stamps);
  next_ = 0;
  lines_ = 0;
  for (const std::uint32_t line : lines) {
    (void)use(line);
  }
}

void RecencyTree::clear() {
  for_each_here([&](std::uint32_t line) { stamp_of(line) = 0; });
  std::uint32_t used = (next_ + (1U << block_bits) - 1) >> block_bits;
  std::fill_n(here_.begin(), used, Block{});
  for (std::vector<std::uint32_t>& counts : blocks_) {
    std::fill_n(counts.begin(), used, 0);
    used = (used + group - 1) >> group_bits;
  }
  next_ = 0;
  lines_ = 0;
}

}  // namespace marti::memory
