// Waiting for another thread that is expected within microseconds.
#pragma once

namespace marti::sim {

/// Returns when ready() is true. give_away() gives the processor to other threads; it is called between looks
/// after `patience` of these, each of which takes some nanoseconds.
template <class Ready, class GiveAway>
void wait_until(const Ready& ready, const GiveAway& give_away, int patience = 1000) {
  for (int looks = 0; !ready(); ++looks) {
    if (looks >= patience) {
      give_away();
    }
  }
}

}  // namespace marti::sim
