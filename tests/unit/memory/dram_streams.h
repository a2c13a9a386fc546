// Streams of accesses to one DRAM memory, defined exactly, and what a memory makes of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "memory/dram_in_order.h"
#include "memory/dram_mapping.h"
#include "memory/dram_queued.h"

namespace marti::memory::test {

/// Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014.
class SplitMix {
 public:
  explicit SplitMix(std::uint64_t state) : state_(state) {}
  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
  double unit() { return static_cast<double>(next() >> 11U) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

struct StreamAccess {
  DramCycle arrival = 0;
  Address address = 0;
  DramPlace place;
  bool write = false;
};

/// `load` is the part of the peak at which lines arrive at random, one at most in a cycle; 0: all at once.
struct Stream {
  // seq, rand1G, randrank (in the whole memory), rw9010 (rand1G, every tenth a write), mix8020 (rand1G, of
  // whose lines four of five are in groups of four in a row) or onebank.
  std::string pattern;
  double load = 0.0;
  std::size_t count = 50000;
  std::uint32_t line = 64;
};

inline std::vector<StreamAccess> make_stream(const DramConfig& config, const Stream& stream) {
  const DramMapping mapping(config);
  SplitMix addresses(12345);
  SplitMix times(67890);
  const std::uint32_t buses = config.channels * (config.pseudo_channels ? config.ranks : 1);
  const double lines_per_cycle =
      static_cast<double>(buses) * config.burst_bytes / (static_cast<double>(config.timing.bl) * stream.line);
  DramCycle now = stream.load > 0.0 ? -1 : 0;
  std::uint32_t group = 0;  // lines that are left of a group in a row
  std::vector<StreamAccess> accesses;
  for (std::size_t i = 0; i < stream.count; ++i) {
    if (stream.load > 0.0) {
      do {
        ++now;
      } while (!(times.unit() < stream.load * lines_per_cycle));
    }
    StreamAccess access;
    access.arrival = now;
    if (stream.pattern == "onebank") {
      access.place.row = static_cast<std::uint32_t>(addresses.next() % config.rows);
      access.address = Address{access.place.row} << 32U;
    } else {
      const std::uint64_t range = stream.pattern == "randrank" ? config.capacity() : 1U << 30U;
      if (stream.pattern == "mix8020") {
        if (group == 0 && addresses.unit() < 0.5) {
          group = 4;
          access.address = stream.line * 4 * (addresses.next() % (range / (stream.line * 4)));
        } else if (group > 0) {
          access.address = accesses.back().address + stream.line;
        } else {
          group = 1;
          access.address = stream.line * (addresses.next() % (range / stream.line));
        }
        --group;
      } else {
        access.address =
            stream.line * (stream.pattern == "seq" ? i : addresses.next() % (range / stream.line));
      }
      access.write = stream.pattern == "rw9010" && addresses.unit() < 0.1;
      access.place = mapping.place(access.address);
    }
    accesses.push_back(access);
  }
  return accesses;
}

struct StreamResult {
  std::vector<DramService> services;  // of each access
  double mean_cycles = 0.0;           // of a read, from its arrival
  DramCycle last_read = 0;            // the end of the last read
  DramCycle last = 0;                 // the end of the last access, as that of the frame
  DramStatistics counts;              // of all channels
};

template <class Channel>
void finish(StreamResult& result, const DramConfig& config, const std::vector<StreamAccess>& accesses,
            const std::vector<Channel>& channels) {
  std::int64_t reads = 0;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < accesses.size(); ++i) {
    result.last = std::max(result.last, result.services[i].end);
    if (!accesses[i].write) {
      ++reads;
      sum += result.services[i].end - accesses[i].arrival;
      result.last_read = std::max(result.last_read, result.services[i].end);
    }
  }
  result.mean_cycles = static_cast<double>(sum) / static_cast<double>(reads);
  for (const Channel& channel : channels) {
    sim::merge(result.counts, channel.statistics(result.last * config.period));
  }
}

inline StreamResult run_in_order(const DramConfig& config, const std::vector<StreamAccess>& accesses,
                                 std::int64_t bursts) {
  StreamResult result;
  std::vector<DramInOrder> channels(config.channels, DramInOrder(config));
  for (const StreamAccess& access : accesses) {
    result.services.push_back(
        channels[access.place.channel].serve({access.place, bursts, access.write, access.arrival}));
  }
  finish(result, config, accesses, channels);
  return result;
}

/// `foresight`: channels are told when their next access arrives, and may serve what meets no other at once.
inline StreamResult run_queued(const DramConfig& config, const std::vector<StreamAccess>& accesses,
                               std::int64_t bursts, bool foresight = true) {
  StreamResult result;
  result.services.resize(accesses.size());
  std::vector<DramQueued> channels(config.channels, DramQueued(config));
  const DramCycle steps = config.steps();
  const auto note = [&](const std::optional<DramDone>& done) {
    if (done) {
      result.services[done->tag] = {(done->service.first + steps - 1) / steps, done->service.end / steps};
    }
  };
  // When the next access of a channel arrives.
  std::vector<sim::Ticks> known(accesses.size());
  std::vector<sim::Ticks> next(config.channels, std::numeric_limits<sim::Ticks>::max());
  for (std::size_t i = accesses.size(); i-- > 0;) {
    known[i] = foresight ? next[accesses[i].place.channel] : 0;
    next[accesses[i].place.channel] = accesses[i].arrival * config.period;
  }
  for (std::size_t i = 0; i < accesses.size(); ++i) {
    const StreamAccess& access = accesses[i];
    DramQueued& channel = channels[access.place.channel];
    const DramCycle arrival = access.arrival * steps;
    while (channel.next() <= arrival) {
      note(channel.step());
    }
    note(channel.enter({access.place, bursts, access.write, arrival}, access.address, i, known[i]));
  }
  for (DramQueued& channel : channels) {
    while (!channel.idle()) {
      note(channel.step());
    }
  }
  finish(result, config, accesses, channels);
  return result;
}

inline StreamResult run_stream(const DramConfig& config, const std::vector<StreamAccess>& accesses,
                               std::int64_t bursts = 1) {
  return config.policy == DramPolicy::fcfs ? run_in_order(config, accesses, bursts)
                                           : run_queued(config, accesses, bursts);
}

}  // namespace marti::memory::test
