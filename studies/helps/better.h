// Better values of a key, by the kind of quantity that it is.
#pragma once

#include <cstdint>
#include <string_view>

#include "studies/helps/resource.h"

namespace marti::studies::helps {

/// A tenth more, rounded up.
[[nodiscard]] std::int64_t tenth_more(std::int64_t count);

/// A clock: a tenth faster, or at periods of a few ticks the next shorter one; at best 1 THz, a cycle of one
/// tick.
[[nodiscard]] Resource faster_clock(const Changer& changer, Part part, std::string_view key);
/// A width in bytes: the next power of two; at best the most that the key may have.
[[nodiscard]] Resource wider(const Changer& changer, Part part, std::string_view key);
/// A number of things: a tenth more; at best `best`, or the most that the key may have.
[[nodiscard]] Resource more(const Changer& changer, Part part, std::string_view key);
[[nodiscard]] Resource more(const Changer& changer, Part part, std::string_view key, std::int64_t best);
/// A number of cycles or bytes that is to be small: divided by 1.1, by at least one
/// less; at best `least`.
[[nodiscard]] Resource fewer(const Changer& changer, Part part, std::string_view key, std::int64_t least = 0);

}  // namespace marti::studies::helps
