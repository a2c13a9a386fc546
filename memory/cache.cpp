#include "memory/cache.h"

#include "memory/tags.h"
#include "sim/error.h"

namespace marti::memory {

struct Cache::TagStore {
  virtual ~TagStore() = default;
  virtual bool access(std::uint32_t line) = 0;
  virtual bool remove(std::uint32_t line) = 0;
};

namespace {

template <class Tags>
struct TagStoreOf final : Cache::TagStore {
  TagStoreOf(const CacheShape& shape, std::uint64_t seed) : tags(shape, 1, seed) {}
  bool access(std::uint32_t line) override { return tags.view(0).access(line); }
  bool remove(std::uint32_t line) override { return tags.view(0).remove(line); }
  Tags tags;
};

}  // namespace

Cache::Cache(const CacheConfig& config) : shape_(shape_of(config)) {
  tags_ = with_tag_store(config.replacement, shape_, [&]<class Tags>() -> std::unique_ptr<TagStore> {
    return std::make_unique<TagStoreOf<Tags>>(shape_, config.seed);
  });
}

Cache::~Cache() = default;
Cache::Cache(Cache&&) noexcept = default;
Cache& Cache::operator=(Cache&&) noexcept = default;

Cache::Lines Cache::lines_of(Address address, std::uint64_t bytes) const {
  if (bytes == 0 || address > ~Address{0} - bytes) {
    throw sim::UserError("an access of 0 bytes or beyond the last address");
  }
  const Lines lines = {address >> shape_.line_shift, (address + bytes - 1) >> shape_.line_shift};
  if (lines.last >= no_line) {
    throw sim::UserError("an address beyond 2^32 - 1 cache lines");
  }
  return lines;
}

std::int64_t Cache::read(Address address, std::uint64_t bytes) {
  const Lines lines = lines_of(address, bytes);
  std::int64_t missed = 0;
  for (Address line = lines.first; line <= lines.last; ++line) {
    missed += tags_->access(static_cast<std::uint32_t>(line)) ? 0 : 1;
  }
  counters_.misses += missed;
  counters_.hits += static_cast<std::int64_t>(lines.last - lines.first + 1) - missed;
  return missed;
}

std::int64_t Cache::invalidate(Address address, std::uint64_t bytes) {
  const Lines lines = lines_of(address, bytes);
  std::int64_t removed = 0;
  for (Address line = lines.first; line <= lines.last; ++line) {
    removed += tags_->remove(static_cast<std::uint32_t>(line)) ? 1 : 0;
  }
  return removed;
}

}  // namespace marti::memory
