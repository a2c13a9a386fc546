#include "memory/tag_array.h"

#include "memory/tags.h"

namespace marti::memory {

struct TagArray::Store {
  virtual ~Store() = default;
  virtual bool access(std::uint32_t cache, std::uint32_t line) = 0;
  virtual bool touch(std::uint32_t cache, std::uint32_t line) = 0;
  virtual bool remove(std::uint32_t cache, std::uint32_t line) = 0;
  virtual bool holds(std::uint32_t cache, std::uint32_t line) = 0;
};

namespace {

template <class Tags>
struct StoreOf final : TagArray::Store {
  StoreOf(const CacheShape& shape, std::uint32_t caches, std::uint64_t seed) : tags(shape, caches, seed) {}
  bool access(std::uint32_t cache, std::uint32_t line) override { return tags.view(cache).access(line); }
  bool touch(std::uint32_t cache, std::uint32_t line) override { return tags.view(cache).touch(line); }
  bool remove(std::uint32_t cache, std::uint32_t line) override { return tags.view(cache).remove(line); }
  bool holds(std::uint32_t cache, std::uint32_t line) override { return tags.view(cache).holds(line); }
  Tags tags;
};

}  // namespace

TagArray::TagArray(const CacheConfig& config, std::uint32_t caches) {
  const CacheShape shape = shape_of(config);
  store_ = with_tag_store(config.replacement, shape, [&]<class Tags>() -> std::unique_ptr<Store> {
    return std::make_unique<StoreOf<Tags>>(shape, caches, config.seed);
  });
}

TagArray::~TagArray() = default;
TagArray::TagArray(TagArray&&) noexcept = default;
TagArray& TagArray::operator=(TagArray&&) noexcept = default;

bool TagArray::access(std::uint32_t cache, std::uint32_t line) { return store_->access(cache, line); }
bool TagArray::touch(std::uint32_t cache, std::uint32_t line) { return store_->touch(cache, line); }
bool TagArray::remove(std::uint32_t cache, std::uint32_t line) { return store_->remove(cache, line); }
bool TagArray::holds(std::uint32_t cache, std::uint32_t line) { return store_->holds(cache, line); }

}  // namespace marti::memory
