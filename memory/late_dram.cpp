#include "memory/late_dram.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::memory {

LateDram::LateDram(const DramConfig& config, const InterconnectSite& site, sim::Ticks notice)
    : site_(site),
      clock_(config),
      notice_(notice),
      mapping_(config),
      burst_bytes_(config.burst_bytes),
      burst_ticks_(config.burst_time()),
      channels_(config.channels, Channel(config)),
      banks_(config.channels),
      writes_(site.ports) {}

std::uint32_t LateDram::announce(const Transaction& transaction, bool write, sim::Ticks arrival) {
  std::uint64_t place = asked_.size();
  if (unused_.empty()) {
    asked_.emplace_back();
  } else {
    place = unused_.back();
    unused_.pop_back();
  }
  asked_[place] = {transaction, write, arrival};
  const std::uint32_t number = mapping_.channel(transaction.address);
  channels_[number].coming.push_back(place);
  return number;
}

void LateDram::begin_event(std::uint32_t channel) {
  std::erase(channels_[channel].events, site_.engine.now());
}

std::optional<DramDone> LateDram::advance(std::uint32_t channel, sim::Ticks known) {
  Channel& c = channels_[channel];
  for (;;) {
    const DramCycle command = c.dram.next();
    if (!c.coming.empty()) {
      const std::uint64_t place = c.coming.front();
      const Asked& asked = asked_[place];
      const DramCycle arrival = clock_.cycle_at(asked.arrival);
      if (arrival < command) {
        c.coming.pop_front();
        const sim::Ticks next = c.coming.empty() ? known : std::min(known, asked_[c.coming.front()].arrival);
        const Transaction& transaction = asked.transaction;
        const DramRequest request = {mapping_.place(transaction.address),
                                     bursts_of(transaction.address, transaction.bytes, burst_bytes_),
                                     asked.write, arrival};
        if (std::optional<DramDone> done =
                c.dram.enter(request, transaction.address & ~Address{burst_bytes_ - 1U}, place, next)) {
          return done;
        }
        continue;
      }
    }
    if (command == DramQueued::never || clock_.ticks(command - 1) >= known) {
      return std::nullopt;
    }
    if (std::optional<DramDone> done = c.dram.step()) {
      return done;
    }
  }
}

LateAccess LateDram::finished(std::uint32_t channel, const DramDone& done) {
  const Asked& asked = asked_[done.tag];
  // A read that is served from the queue of writes has no command: it begins and ends in one cycle.
  const bool forwarded = done.service.first == done.service.end;
  const std::int64_t bursts =
      forwarded ? 0 : bursts_of(asked.transaction.address, asked.transaction.bytes, burst_bytes_);
  unused_.push_back(done.tag);
  const sim::Ticks start = clock_.cycle_before(done.service.first);
  banks_[channel].add(sim::multiply_ticks(burst_ticks_, bursts), start - asked.arrival);
  return {asked.transaction, asked.write, asked.arrival, start, clock_.ticks(done.service.end)};
}

void LateDram::wake(std::uint32_t channel) {
  if (const DramCycle command = channels_[channel].dram.next(); command != DramQueued::never) {
    post(channel, command);
  }
}

void LateDram::post(std::uint32_t channel, DramCycle command) {
  const sim::Ticks time = std::max(decided_at(command), site_.engine.now());
  std::vector<sim::Ticks>& events = channels_[channel].events;
  if (std::any_of(events.begin(), events.end(), [&](sim::Ticks event) { return event <= time; })) {
    return;
  }
  events.push_back(time);
  site_.engine.post(sim::Event::make(time, site_.memory_class, site_.first_component, 1 + channel));
}

std::vector<DramStatistics> LateDram::statistics(sim::Ticks end) const {
  std::vector<DramStatistics> all;
  for (const Channel& channel : channels_) {
    all.push_back(channel.dram.statistics(end));
  }
  return all;
}

void WriteOrder::finish(std::uint32_t port, Address address, sim::Ticks done, InterconnectClient& client) {
  std::vector<Write>& writes = ports_[port];
  const auto write = std::find_if(writes.begin(), writes.end(), [&](const Write& made) {
    return made.address == address && made.done == not_done;
  });
  sim::ensure(write != writes.end(), "a write is done that was not made");
  write->done = done;
  while (!writes.empty() && writes.front().done != not_done) {
    const sim::Ticks oldest = writes.front().done;
    writes.erase(writes.begin());
    client.write_done(port, oldest);
  }
}

}  // namespace marti::memory
