#include <algorithm>
#include <string>
#include <string_view>

#include "studies/helps/resource_lists.h"

namespace marti::studies::helps {

namespace {

using memory::DramPage;
using memory::DramPolicy;
using memory::DramTiming;

// Divided by 1.1, and at least one less.
std::int64_t less(std::int64_t now) { return std::max<std::int64_t>(std::min(now - 1, now * 10 / 11), 0); }

}  // namespace

void add_dram(const Changer& changer, const memory::DramConfig& dram, std::vector<Resource>& resources) {
  const auto add = [&](std::string_view key, const std::optional<Change>& step,
                       const std::optional<Change>& best = std::nullopt) {
    resources.push_back({std::string(key), Part::banks, step, best});
  };
  const auto set = [&](std::string_view key, std::int64_t to, std::int64_t from) {
    return changer.with({{key, to, from}});
  };
  add("dram.tck", set("dram.tck", std::max<std::int64_t>(less(dram.period), 1), dram.period),
      set("dram.tck", 1, dram.period));
  add("dram.channels", set("dram.channels", std::int64_t{dram.channels} * 2, dram.channels));
  const DramTiming& times = dram.timing;
  add("dram.tcl", set("dram.tcl", less(times.cl), times.cl));
  add("dram.trcd", set("dram.trcd", less(times.rcd), times.rcd));
  add("dram.trp", set("dram.trp", less(times.rp), times.rp));
  const auto choose = [&](std::string_view key, std::string_view other) {
    add(key, changer.with({{key, std::string(other)}}));
  };
  choose("dram.page", memory::dram_page_names[dram.page == DramPage::open ? 1 : 0]);
  if (dram.policy == DramPolicy::fcfs) {
    choose("dram.policy", memory::dram_policy_names[1]);
  } else if (!changer.given("dram.queue") && !changer.given("dram.reorder_cap")) {
    choose("dram.policy", memory::dram_policy_names[0]);  // has no use for these keys
  }
}

}  // namespace marti::studies::helps
