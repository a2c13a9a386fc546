// Signals that end the program: what it leaves behind then.
#pragma once

#include <mutex>

namespace marti::studies {

/// To be called by main() before it starts any thread. From then on SIGINT, SIGTERM and SIGHUP, unless they
/// are ignored, end the program as they always do, but first the temporary files of unfinished output are
/// removed, and while a SignalsHeld lives they wait.
void end_cleanly_on_signals();

/// Keeps such a signal from splitting a set of files into old and new ones.
class SignalsHeld {
 public:
  SignalsHeld();

 private:
  std::unique_lock<std::recursive_mutex> lock_;
};

}  // namespace marti::studies
