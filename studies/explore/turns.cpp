#include "studies/explore/turns.h"

namespace marti::studies::explore {

Turns::Turn::~Turn() {
  if (turns_ != nullptr) {
    const std::lock_guard lock(turns_->mutex_);
    turns_->taken_ = nullptr;
    turns_->changed_.notify_all();
  }
}

void Turns::stop() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  if (taken_) {
    taken_->stop();
  }
  changed_.notify_all();
}

sim::WorkMeter::State Turns::state() const {
  const std::lock_guard lock(mutex_);
  return taken_ ? taken_->state() : sim::WorkMeter::State();
}

std::optional<Turns::Turn> Turns::take(Asker asker) {
  std::unique_lock lock(mutex_);
  const bool reader = asker == Asker::reader;
  std::uint64_t& newest = reader ? newest_reader_ : newest_background_;
  const std::uint64_t mine = ++newest;
  if (reader) {
    ++newest_background_;
    reader_waits_ = true;
    if (taken_) {
      taken_->stop();
    }
  }
  changed_.notify_all();  // those whose place is taken now
  changed_.wait(lock, [&] { return ended_ || newest != mine || (!taken_ && (reader || !reader_waits_)); });
  if (ended_ || newest != mine) {
    return std::nullopt;
  }
  if (reader) {
    reader_waits_ = false;
  }
  taken_ = std::make_shared<sim::WorkMeter>();
  return std::optional<Turn>(std::in_place, *this, taken_);
}

}  // namespace marti::studies::explore
