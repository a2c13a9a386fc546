#include "memory/miss_classes.h"

namespace marti::memory {

MissClassifier::MissClassifier(std::uint64_t lines, std::uint32_t caches)
    : full_({.size = lines, .line = 1, .ways = full_ways}, caches), had_(caches), taken_(caches) {}

MissClass MissClassifier::miss(std::uint32_t cache, std::uint32_t line) {
  const bool in_full = full_.access(cache, line);
  if (had_[cache].insert(line)) {
    return MissClass::compulsory;
  }
  if (taken_[cache].erase(line)) {
    return MissClass::invalidation;
  }
  return in_full ? MissClass::conflict : MissClass::capacity;
}

void MissClassifier::written(std::uint32_t cache, std::uint32_t line, bool held) {
  (void)full_.remove(cache, line);
  if (held) {
    taken_[cache].insert(line);
  }
}

}  // namespace marti::memory
