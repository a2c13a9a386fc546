#include "sim/avx2.h"

namespace marti::sim {

#ifdef MARTI_AVX2
bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}
#endif

}  // namespace marti::sim
