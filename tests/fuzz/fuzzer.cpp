// The entry that libFuzzer calls; MARTI_FUZZ_TARGET is the target of this program.
#include <cstddef>
#include <cstdint>

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  marti::fuzz::MARTI_FUZZ_TARGET({data, size});
  return 0;
}
