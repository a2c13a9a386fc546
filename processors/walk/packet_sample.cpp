#include "processors/walk/packet_sample.h"

#include <utility>

#include "sim/error.h"

namespace marti::processors::walk {

PacketSample::PacketSample(std::vector<std::uint64_t> chosen, std::uint64_t packets, std::uint64_t warm_up)
    : chosen_(std::move(chosen)), is_chosen_(packets), warm_up_(warm_up) {
  sim::ensure(!chosen_.empty(), "a sample has no packet");
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    sim::ensure(chosen_[i] < packets && (i == 0 || chosen_[i - 1] < chosen_[i]),
                "the packets of a sample are not ascending, or there is no such packet");
    is_chosen_[chosen_[i]] = true;
  }
}

}  // namespace marti::processors::walk
