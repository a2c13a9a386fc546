// Better values of a key, by the kind of quantity that it is.
#pragma once

#include <cstdint>
#include <string_view>

#include "studies/helps/resource.h"

namespace marti::studies::helps {

/// A tenth more, rounded up.
[[nodiscard]] std::int64_t tenth_more(std::int64_t count);

/// A clock: a tenth faster, or at periods of a few ticks the next shorter one; 1 THz, a cycle of one tick.
[[nodiscard]] Resource faster_clock(const Changer& changer, Part part, std::string_view key);
/// A width in bytes: the next power of two; the most that the key may have.
[[nodiscard]] Resource wider(const Changer& changer, Part part, std::string_view key);
/// A number of things: a tenth more; `best`, or the most that the key may have.
[[nodiscard]] Resource more(const Changer& changer, Part part, std::string_view key);
[[nodiscard]] Resource more(const Changer& changer, Part part, std::string_view key, std::int64_t best);
/// A number of cycles or bytes that is to be small: eleven tenths become ten, or one less; `least`.
[[nodiscard]] Resource fewer(const Changer& changer, Part part, std::string_view key, std::int64_t least = 0);

}  // namespace marti::studies::helps
