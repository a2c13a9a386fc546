#include "studies/host/signals_held.h"

#include <unistd.h>

#include <csignal>
#include <thread>
#include <utility>

#include "sim/files.h"

namespace marti::studies::host {

namespace {

// Never destroyed: the watching thread outlives main().
std::recursive_mutex& held() {
  static auto& mutex = *new std::recursive_mutex;  // NOLINT(cppcoreguidelines-owning-memory)
  return mutex;
}

struct Action {
  std::function<void(int)> what{};
  AtSignal::Then then = AtSignal::Then::exit;
};
Action& action() {
  static auto& one = *new Action;  // NOLINT(cppcoreguidelines-owning-memory)
  return one;
}

// Waits for one of the signals. All threads block them, because a thread inherits the mask of the one that
// starts it; so only sigwait() receives them.
void watch(const sigset_t& signals) {
  int signal = 0;
  if (sigwait(&signals, &signal) != 0) {
    return;
  }
  held().lock();  // never unlocked: no output may begin any more
  sim::abandon_pending_files();
  if (action().what) {
    action().what(signal);
    if (action().then == AtSignal::Then::exit) {
      _exit(128 + signal);  // the status that a shell reports for a signal
    }
  }
  std::signal(signal, SIG_DFL);
  sigset_t mine;
  sigemptyset(&mine);
  sigaddset(&mine, signal);
  pthread_sigmask(SIG_UNBLOCK, &mine, nullptr);
  std::raise(signal);
}

}  // namespace

void end_cleanly_on_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  bool any = false;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // sigwait() would also receive an ignored signal, such as SIGHUP under nohup.
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) {
      sigaddset(&signals, signal);
      any = true;
    }
  }
  if (!any) {
    return;
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread(watch, signals).detach();
}

SignalsHeld::SignalsHeld() : lock_(held()) {}

AtSignal::AtSignal(std::function<void(int signal)> what, Then then) {
  const SignalsHeld hold;
  action() = {std::move(what), then};
}

AtSignal::~AtSignal() {
  const SignalsHeld hold;
  action() = {};
}

}  // namespace marti::studies::host
