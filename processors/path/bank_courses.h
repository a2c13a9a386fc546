// The chains of the accesses of a shared memory's banks, with or without a cache before them.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "memory/bank.h"
#include "memory/dram.h"
#include "memory/interconnect.h"
#include "processors/path/path_pieces.h"

namespace marti::processors::path {

class BankCourses {
 public:
  /// `memory` has the banks; it tells which reads hit its cache.
  BankCourses(const memory::BankConfig& config, const memory::Interconnect& memory, PathPieces& pieces);

  /// The chain of a read whose address arrives with `arriving`, up to its data. Called after the memory has
  /// looked the read up and before it looks up another one.
  PathTip read(memory::Address address, std::uint32_t bytes, const PathTip& arriving, const PathOwner& owner);
  PathTip write(memory::Address address, std::uint32_t bytes, const PathTip& arriving,
                const PathOwner& owner) {
    return access(address, bytes, true, arriving, owner);
  }
  [[nodiscard]] std::uint32_t bank_of(memory::Address address) const {
    if (dram_) {
      return dram_->channel_of(address);
    }
    return static_cast<std::uint32_t>(address / interleave_ % banks_.size());
  }

 private:
  // An access of DRAM is one piece from its arrival to its data: what it waits for is part of it.
  PathTip access(memory::Address address, std::uint32_t bytes, bool write, const PathTip& arriving,
                 const PathOwner& owner);
  void forget_arrived(sim::Ticks now);

  PathPieces& pieces_;
  const memory::Interconnect& memory_;
  std::uint32_t interleave_;
  sim::Ticks access_;
  sim::Ticks busy_;
  std::optional<memory::Dram> dram_;  // serves the same accesses once more
  std::optional<sim::Ticks> hit_;     // with a cache
  std::uint32_t line_ = 1;            // of the cache
  std::int64_t hits_ = 0;             // of the cache so far
  std::vector<PathTip> banks_;        // what each bank did last, until it can begin its next access
  std::unordered_map<memory::Address, PathTip>
      coming_;  // lines brought in; those that have arrived are removed now and then
  std::size_t most_coming_ = 64;
};

}  // namespace marti::processors::path
