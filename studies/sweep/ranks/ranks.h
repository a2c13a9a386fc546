// The processes of one job, and messages between them: MPI, as far as a sweep needs it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace marti::studies::sweep {

/// How long a process that waits for another one sleeps before it looks again.
inline constexpr auto pause = std::chrono::milliseconds(1);

/// Made at most once in a process, and used only by the thread that made it. It sleeps whenever it waits for
/// other processes, except at the beginning and at the end.
class Ranks {
 public:
  /// Joins the other processes. Throws UserError when the program was built without MPI, or the launcher is
  /// not that of the MPI it was built with.
  Ranks();
  /// Leaves the job; every rank must do so. While messages are not received or an exception passes, it does
  /// not leave: end the process by end_all_ranks() then.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] std::size_t rank() const { return rank_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// How many ranks run on this computer, this one among them.
  [[nodiscard]] std::size_t on_this_computer() const { return local_; }

  /// Returns at once; messages to one rank arrive in their order. Any size.
  void send(std::size_t to, std::string message);

  struct Message {
    std::size_t from = 0;
    std::string bytes;
  };
  /// The next message that has arrived, if there is one.
  [[nodiscard]] std::optional<Message> receive();
  /// The next message, sleeping until it is there.
  [[nodiscard]] Message wait();
  /// Waits until all messages sent are received, or at least on their way.
  void flush();

 private:
  struct Outbox;
  std::size_t rank_ = 0;
  std::size_t size_ = 1;
  std::size_t local_ = 1;
  std::unique_ptr<Outbox> outbox_;
};

/// Ends this process and all others of its job with that status, if it has joined one; otherwise returns.
void end_all_ranks(int status);

/// Threads that this rank should use: the processors it may run on, shared with the ranks beside it unless
/// the launcher has bound each to its own.
[[nodiscard]] unsigned threads_of_rank(const Ranks& ranks);

}  // namespace marti::studies::sweep
