// A DRAM channel that looks at every cycle and at every command so far: slow, and independent of the tables
// of next times in memory/dram_device.h.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "memory/dram_config.h"
#include "tests/unit/memory/dram_streams.h"

namespace marti::memory::test {

class NaiveDram {
 public:
  NaiveDram(const DramConfig& config, const std::vector<StreamAccess>& accesses, std::int64_t bursts)
      : config_(config), t_(config.timing_of_commands()), open_(config.ranks * config.banks_of_rank(), -1) {
    for (std::size_t i = 0; i < accesses.size(); ++i) {
      for (std::int64_t b = 0; b < bursts; ++b) {
        bursts_.push_back({accesses[i].place, accesses[i].arrival, i, accesses[i].write, b + 1 == bursts});
      }
    }
    services_.resize(accesses.size());
  }

  /// Serves all accesses; returns the services of each.
  std::vector<DramService> run() {
    std::size_t left = bursts_.size();
    for (cycle_ = 0; left > 0; ++cycle_) {
      if (t_.refi > 0 && cycle_ > 0 && cycle_ % t_.refi == 0) {
        for (std::uint32_t rank = 0; rank < config_.ranks; ++rank) {
          refreshes_.push_back(rank);
        }
      }
      left -= config_.policy == DramPolicy::fcfs ? serve_in_order() : serve_queued();
      move_in();
    }
    return services_;
  }
  /// What the data buses do in all cycles of a frame that ends with its last data, by the rule of
  /// memory/dram_buses.h.
  struct BusCycles {
    std::int64_t data = 0, no_request = 0, refresh = 0, rows = 0, turn = 0;
  };
  [[nodiscard]] BusCycles bus_cycles() const {
    BusCycles cycles;
    DramCycle end = 0;
    for (const DramService& service : services_) {
      end = std::max(end, service.end);
    }
    for (std::uint32_t bus = 0; bus < (config_.pseudo_channels ? config_.ranks : 1); ++bus) {
      std::vector<const Burst*> moved;  // those of this bus, in the order of their data
      for (const Burst& burst : bursts_) {
        if (!config_.pseudo_channels || burst.place.rank == bus) {
          moved.push_back(&burst);
        }
      }
      std::sort(moved.begin(), moved.end(),
                [&](const Burst* a, const Burst* b) { return data_of(*a) < data_of(*b); });
      for (DramCycle cycle = 0; cycle < end; ++cycle) {
        const auto next = std::find_if(moved.begin(), moved.end(),
                                       [&](const Burst* b) { return data_of(*b) + t_.bl > cycle; });
        if (next == moved.end()) {
          ++cycles.no_request;
        } else if (data_of(**next) <= cycle) {
          ++cycles.data;
        } else {
          const DramCycle then = cycle - latency_of(**next);
          const bool asked =
              std::any_of(next, moved.end(), [&](const Burst* b) { return b->arrival < then; });
          ++(!asked                     ? cycles.no_request
             : refreshing(**next, then) ? cycles.refresh
             : closed(**next, then)     ? cycles.rows
                                        : cycles.turn);
        }
      }
    }
    return cycles;
  }
  [[nodiscard]] std::int64_t activations() const {
    return std::count_if(history_.begin(), history_.end(), [](const Issued& c) { return c.kind == act; });
  }

 private:
  enum Kind { act, pre, rd, wr, pre_all, ref };
  struct Burst {
    DramPlace place;
    DramCycle arrival = 0;
    std::size_t access = 0;
    bool write = false;
    bool last = false;
    enum State { outside, before, queued, active, done } state = outside;
    std::int64_t passed = 0;
    DramCycle command = 0;  // its read or write
  };
  struct Issued {
    Kind kind;
    DramPlace place;
    DramCycle cycle;
    bool close;
  };

  [[nodiscard]] DramCycle latency_of(const Burst& burst) const { return burst.write ? t_.cwl : t_.cl; }
  [[nodiscard]] DramCycle data_of(const Burst& burst) const { return burst.command + latency_of(burst); }
  // Whether a refresh of the burst's rank that came before its command was due or under way.
  [[nodiscard]] bool refreshing(const Burst& burst, DramCycle cycle) const {
    DramCycle due = 0;
    for (const Issued& command : history_) {
      if (command.kind == ref && command.place.rank == burst.place.rank) {
        due += t_.refi;
        if (command.cycle < burst.command && due <= cycle && cycle < command.cycle + t_.rfc) {
          return true;
        }
      }
    }
    return false;
  }
  // Whether the burst had not arrived, or the activation before its command had not opened its row.
  [[nodiscard]] bool closed(const Burst& burst, DramCycle cycle) const {
    DramCycle opened = 0;
    for (const Issued& command : history_) {
      if (command.kind == act && command.place.bank == burst.place.bank && command.cycle < burst.command) {
        opened = command.cycle + (burst.write ? t_.rcd_write : t_.rcd);
      }
    }
    return burst.arrival >= cycle || opened > cycle;
  }

  // From an activation to the next one, if the row was closed as early as possible. One more than tRC is the
  // rounding of tRAS and tRP by themselves.
  [[nodiscard]] DramCycle open_and_closed() const {
    const DramCycle sum = config_.timing.ras + config_.timing.rp;
    return sum == config_.timing.rc + 1 ? config_.timing.rc : sum;
  }
  // The least time from an issued command to a new one; negative if there is none.
  [[nodiscard]] DramCycle between(const Issued& a, Kind b, const DramPlace& place) const {
    const bool same_rank = a.place.rank == place.rank;
    const bool same_group = a.place.group == place.group && a.kind != ref && a.kind != pre_all;
    const bool same_bank = a.place.bank == place.bank && a.kind != ref && a.kind != pre_all;
    const DramCycle written = t_.cwl + t_.bl;
    DramCycle least = -1;
    const auto at_least = [&](bool applies, DramCycle time) {
      least = applies ? std::max(least, time) : least;
    };
    const bool to_data = b == rd || b == wr;
    // One bank.
    at_least(same_bank && a.kind == act && b == rd, t_.rcd);
    at_least(same_bank && a.kind == act && b == wr, t_.rcd_write);
    at_least(same_bank && a.kind == act && b == pre, t_.ras);
    at_least(same_bank && a.kind == act && b == act, t_.rc);
    at_least(same_bank && a.kind == pre && b == act, t_.rp);
    at_least(same_bank && a.kind == rd && b == pre, t_.rtp);
    at_least(same_bank && a.kind == wr && b == pre, written + t_.wr);
    // A row is closed before the next activation of its bank: by a precharge, or by the device as soon as one
    // would be allowed.
    at_least(same_bank && a.kind == act && b == act, open_and_closed());
    at_least(same_bank && a.kind == rd && b == act, t_.rtp + t_.rp);
    at_least(same_bank && a.kind == wr && b == act, written + t_.wr + t_.rp);
    // One rank.
    at_least(same_rank && a.kind == act && b == act, same_group ? t_.rrd_l : t_.rrd_s);
    at_least(same_rank && a.kind == rd && b == rd, same_group ? t_.ccd_l : t_.ccd_s);
    at_least(same_rank && a.kind == rd && b == rd && a.place.stack != place.stack, t_.ccd_stack);
    at_least(same_rank && a.kind == wr && b == wr, same_group ? t_.ccd_l_write : t_.ccd_s);
    at_least(same_rank && a.kind == rd && b == wr, t_.cl + t_.bl + t_.rtw_gap - t_.cwl);
    at_least(same_rank && a.kind == wr && b == rd, written + (same_group ? t_.wtr_l : t_.wtr_s));
    at_least(same_rank && a.kind == ref && b == act, t_.rfc);
    at_least(same_rank && a.kind == pre_all && b == act, t_.rp);
    const bool closes = b == pre || b == pre_all;
    at_least(same_rank && (a.kind == pre || a.kind == pre_all) && closes, t_.ppd);
    at_least(same_rank && a.kind == act && b == pre_all, t_.ras);
    if (same_rank && b == ref) {
      // Times to an activation are counted to its last cycle, but a refresh has one cycle only.
      const DramCycle later = config_.activate_cycles - 1;
      at_least(a.kind == act, std::max(t_.rc, open_and_closed()) + later);
      at_least(a.kind == pre_all || (a.kind == pre && config_.refresh_after_precharge), t_.rp + later);
      at_least(a.kind == rd && a.close, t_.rtp + t_.rp + later);
      at_least(a.kind == wr && a.close, written + t_.wr + t_.rp + later);
    }
    if (same_rank && b == pre_all && open_[a.place.bank] >= 0) {
      at_least(a.kind == rd, t_.rtp);
      at_least(a.kind == wr, written + t_.wr);
    }
    // Data of two ranks.
    const DramCycle end = (a.kind == rd ? t_.cl : t_.cwl) + t_.bl + t_.rank_gap;
    at_least(!config_.pseudo_channels && !same_rank && (a.kind == rd || a.kind == wr) && to_data,
             end - (b == rd ? t_.cl : t_.cwl));
    return least;
  }

  [[nodiscard]] bool allowed(Kind kind, const DramPlace& place) const {
    const bool column = kind == rd || kind == wr;
    if (cycle_ < (column ? column_free_ : row_free_)) {
      return false;
    }
    int activations = 0;
    for (std::size_t i = history_.size(); i-- > 0;) {
      const Issued& a = history_[i];
      if (cycle_ - a.cycle > 2000) {
        break;
      }
      if (cycle_ - a.cycle < between(a, kind, place)) {
        return false;
      }
      activations += a.kind == act && a.place.rank == place.rank && cycle_ - a.cycle < t_.faw ? 1 : 0;
    }
    return kind != act || activations < 4;
  }

  void issue(Kind kind, const DramPlace& place, bool close = false) {
    history_.push_back({kind, place, cycle_, close});
    const bool column = kind == rd || kind == wr;
    const DramCycle free = cycle_ + (column        ? config_.column_cycles
                                     : kind == act ? config_.activate_cycles
                                                   : 1);
    if (column || !config_.two_command_buses) {
      column_free_ = free;
    }
    if (!column || !config_.two_command_buses) {
      row_free_ = free;
    }
    if (kind == act) {
      open_[place.bank] = place.row;
    } else if (kind == pre || close) {
      open_[place.bank] = -1;
    } else if (kind == pre_all) {
      const std::uint32_t banks = config_.banks_of_rank();
      std::fill_n(open_.begin() + place.rank * banks, banks, -1);
    }
  }

  [[nodiscard]] Kind next_of(const Burst& burst) const {
    const std::int64_t row = open_[burst.place.bank];
    return row == burst.place.row ? (burst.write ? wr : rd) : row < 0 ? act : pre;
  }

  // In order, a row is closed by the last burst of an access. Out of order, by one that finds no other burst
  // of its access in the controller.
  [[nodiscard]] bool closes(const Burst& burst) const {
    return config_.policy == DramPolicy::fcfs
               ? burst.last
               : std::none_of(bursts_.begin(), bursts_.end(), [&](const Burst& other) {
                   return &other != &burst && other.access == burst.access &&
                          (other.state == Burst::queued || other.state == Burst::active);
                 });
  }
  // Issues the burst's next command; returns 1 if that ends it.
  std::size_t advance(Burst& burst) {
    const Kind kind = next_of(burst);
    DramService& service = services_[burst.access];
    if (service.first == 0) {
      service.first = cycle_;
    }
    const bool column = kind == rd || kind == wr;
    issue(kind, burst.place, column && config_.page == DramPage::closed && closes(burst));
    if (kind == act) {
      burst.state = Burst::active;
    }
    if (!column) {
      return 0;
    }
    burst.state = Burst::done;
    burst.command = cycle_;
    service.end = std::max(service.end, cycle_ + (burst.write ? t_.cwl : t_.cl) + t_.bl);
    return 1;
  }

  [[nodiscard]] bool any_active(std::int64_t rank) const {
    return std::any_of(bursts_.begin(), bursts_.end(), [&](const Burst& b) {
      return b.state == Burst::active && (rank < 0 || b.place.rank == rank);
    });
  }
  // Issues a command of the refresh that is due, if one is allowed.
  void serve_refresh() {
    DramPlace place;
    place.rank = refreshes_.front();
    const std::uint32_t banks = config_.banks_of_rank();
    const auto first = open_.begin() + place.rank * banks;
    const bool open = std::any_of(first, first + banks, [](std::int64_t row) { return row >= 0; });
    if (allowed(open ? pre_all : ref, place)) {
      issue(open ? pre_all : ref, place);
      if (!open) {
        refreshes_.erase(refreshes_.begin());
      }
    }
  }

  std::size_t serve_in_order() {
    std::size_t ended = 0;
    const auto waits = [&](const Burst& b) { return b.state != Burst::done && b.arrival < cycle_; };
    const auto front = std::find_if(bursts_.begin(), bursts_.end(), waits);
    const bool refresh = !refreshes_.empty();
    if (front != bursts_.end() && (next_of(*front) == rd || next_of(*front) == wr) &&
        (!refresh || front->state == Burst::active) && allowed(next_of(*front), front->place)) {
      ended = advance(*front);
    }
    if (refresh) {
      if (!any_active(-1)) {
        serve_refresh();
      }
      return ended;
    }
    // The oldest that has not opened its row.
    const auto closed = std::find_if(bursts_.begin(), bursts_.end(),
                                     [&](const Burst& b) { return waits(b) && b.state != Burst::active; });
    // A command that takes several cycles must leave the bus to the data of older accesses in time.
    for (DramCycle ahead = 1; ahead < config_.activate_cycles && !config_.two_command_buses; ++ahead) {
      const auto first = std::find_if(bursts_.begin(), bursts_.end(), waits);
      cycle_ += ahead;
      const bool due = closed != bursts_.end() && next_of(*closed) == act && first->state == Burst::active &&
                       allowed(next_of(*first), first->place);
      cycle_ -= ahead;
      if (due) {
        return ended;
      }
    }
    if (closed == bursts_.end() || next_of(*closed) == rd || next_of(*closed) == wr ||
        !allowed(next_of(*closed), closed->place)) {
      return ended;
    }
    const bool in_use =
        next_of(*closed) == pre && std::any_of(bursts_.begin(), bursts_.end(), [&](const Burst& b) {
          return b.state == Burst::active && b.place.bank == closed->place.bank;
        });
    if (!in_use) {
      advance(*closed);
    }
    return ended;
  }

  [[nodiscard]] std::size_t queued(bool write) const {
    return static_cast<std::size_t>(std::count_if(bursts_.begin(), bursts_.end(), [&](const Burst& b) {
      return b.state == Burst::queued && b.write == write;
    }));
  }
  // Lets arrived bursts into the queues, in order, as far as there is room.
  void move_in() {
    for (Burst& burst : bursts_) {
      if (burst.state != Burst::outside) {
        continue;
      }
      if (burst.arrival > cycle_ || queued(burst.write) >= config_.queue) {
        return;
      }
      burst.state = Burst::queued;
    }
  }
  void review_writing() {
    const std::size_t writes = queued(true);
    const bool reads = queued(false) > 0;
    if (!writing_ && (5 * writes > 4 * std::size_t{config_.queue} || !reads)) {
      writing_ = true;
    } else if (writing_ && 5 * writes < config_.queue && reads) {
      writing_ = false;
    }
  }

  std::size_t serve_queued() {
    std::size_t ended = 0;
    // With two command buses a cycle has a read or write, and then a command that opens or closes a row.
    for (int bus = 0; bus < (config_.two_command_buses ? 2 : 1); ++bus) {
      const bool rows = !config_.two_command_buses || bus == 1;
      const auto can_have = [&](const Burst& burst) {
        const Kind kind = next_of(burst);
        const bool has_bus = !config_.two_command_buses || (kind == rd || kind == wr) == (bus == 0);
        return has_bus && allowed(kind, burst.place);
      };
      Burst* chosen = nullptr;
      for (Burst& burst : bursts_) {
        if (burst.state == Burst::active && can_have(burst)) {
          chosen = &burst;
          break;
        }
      }
      if (chosen != nullptr) {
        ended += advance(*chosen);
        continue;
      }
      if (!refreshes_.empty()) {
        if (rows && !any_active(refreshes_.front())) {
          serve_refresh();
        }
        continue;
      }
      review_writing();
      for (Burst& burst : bursts_) {
        if (burst.state != Burst::queued || burst.write != writing_) {
          continue;
        }
        const bool in_use =
            next_of(burst) == pre && std::any_of(bursts_.begin(), bursts_.end(), [&](const Burst& b) {
              return b.state == Burst::active && b.place.bank == burst.place.bank;
            });
        if (!in_use && can_have(burst)) {
          chosen = &burst;
          break;
        }
        if (config_.reorder_cap > 0 && burst.passed >= config_.reorder_cap) {
          break;
        }
      }
      if (chosen != nullptr) {
        ended += advance(*chosen);
        if (chosen->state != Burst::queued) {
          for (Burst* older = bursts_.data(); older != chosen; ++older) {
            older->passed += older->state == Burst::queued && older->write == chosen->write ? 1 : 0;
          }
        }
      }
    }
    return ended;
  }

  DramConfig config_;
  DramTiming t_;
  std::vector<std::int64_t> open_;
  std::vector<Burst> bursts_;
  std::vector<DramService> services_;
  std::vector<Issued> history_;
  std::vector<std::uint32_t> refreshes_;
  DramCycle cycle_ = 0;
  DramCycle column_free_ = 0;
  DramCycle row_free_ = 0;
  bool writing_ = false;
};

}  // namespace marti::memory::test
