// Signals that end the program: what it leaves behind then.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>

namespace marti::studies::host {

/// To be called by main() before it starts any thread. From then on SIGINT, SIGTERM and SIGHUP, unless they
/// are ignored, still end the program, but first the temporary files of unfinished output are removed; and
/// while a SignalsHeld lives, the signals wait.
void end_cleanly_on_signals();

/// Keeps such a signal from splitting a set of files into old and new ones.
class SignalsHeld {
 public:
  SignalsHeld();

 private:
  std::unique_lock<std::recursive_mutex> lock_;
};

/// An action for the case that such a signal comes while this lives: it is called once, in a thread of its
/// own, after temporary files are removed; then the program ends. One at a time.
class AtSignal {
 public:
  enum class Then : std::uint8_t {
    exit,   ///< with status 128 + signal
    signal  ///< by the signal, as without an action
  };
  explicit AtSignal(std::function<void(int signal)> action, Then then = Then::exit);
  /// If the action has begun, waits for it and does not return: the program exits.
  ~AtSignal();
  AtSignal(const AtSignal&) = delete;
  AtSignal& operator=(const AtSignal&) = delete;
};

}  // namespace marti::studies::host
