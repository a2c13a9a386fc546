// Whether the host has vector instructions that not every processor of its kind has.
#pragma once

#if defined(__x86_64__)
#define MARTI_AVX2 1

namespace marti::sim {

/// Whether the host has AVX2.
[[nodiscard]] bool has_avx2();

}  // namespace marti::sim

#endif
