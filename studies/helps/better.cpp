#include "studies/helps/better.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <variant>

namespace marti::studies::helps {

namespace {

std::int64_t whole(const Changer& changer, std::string_view key) {
  return std::get<std::int64_t>(changer.now(key));
}

Resource made(const Changer& changer, Part part, std::string_view key, const sim::Value& step,
              const sim::Value& best) {
  return {std::string(key), part, changer.with({{key, step}}), changer.with({{key, best}})};
}

}  // namespace

std::int64_t tenth_more(std::int64_t count) { return count + (count + 9) / 10; }

Resource faster_clock(const Changer& changer, Part part, std::string_view key) {
  const auto now = std::get<double>(changer.now(key));
  const sim::Ticks period = sim::Clock::from_hertz(now).period();
  const double fastest = std::get<double>(*changer.key(key).maximum);
  double faster = std::min(fastest, std::round(now * 11.0 / 10.0));
  if (sim::Clock::from_hertz(faster).period() == period && period > 1) {
    faster = std::round(static_cast<double>(sim::ticks_per_second) / static_cast<double>(period - 1));
  }
  Resource clock = made(changer, part, key, faster, fastest);
  if (period == 1) {
    clock.step.reset();
    clock.best.reset();
  }
  return clock;
}

Resource wider(const Changer& changer, Part part, std::string_view key) {
  const auto next = std::bit_ceil(static_cast<std::uint64_t>(whole(changer, key)) + 1);
  return made(changer, part, key, static_cast<std::int64_t>(next), *changer.key(key).maximum);
}

Resource more(const Changer& changer, Part part, std::string_view key) {
  return more(changer, part, key, std::get<std::int64_t>(*changer.key(key).maximum));
}

Resource more(const Changer& changer, Part part, std::string_view key, std::int64_t best) {
  const std::int64_t now = whole(changer, key);
  return made(changer, part, key, tenth_more(now), std::max(now, best));
}

Resource fewer(const Changer& changer, Part part, std::string_view key, std::int64_t least) {
  const std::int64_t now = whole(changer, key);
  // Of large numbers the quotient comes first, so that the product does not overflow.
  const std::int64_t less = now > 1'000'000 ? now / 11 * 10 : now * 10 / 11;
  return made(changer, part, key, std::clamp(std::min(now - 1, less), std::min(least, now), now), least);
}

}  // namespace marti::studies::helps
