// Whether walks on vectors can be used.
#pragma once

#if defined(__x86_64__)
#define MARTI_ACCEL_AVX2 1

namespace marti::accel {

/// Whether this machine has AVX2.
[[nodiscard]] bool has_avx2();

}  // namespace marti::accel

#endif
