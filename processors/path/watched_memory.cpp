#include "processors/path/watched_memory.h"

#include <utility>

#include "processors/node/memory_system.h"
#include "sim/error.h"

namespace marti::processors::path {

WatchedMemory::WatchedMemory(const machine::MachineConfig& config, const memory::InterconnectSite& site,
                             PathRecorder& recorder)
    : PassedOn(node::make_memory_system(config, {site.engine, *this, site.reply_class, site.first_component,
                                                 site.ports, site.memory_class})),
      site_(site),
      recorder_(recorder),
      course_(make_memory_course(config, next(), recorder.pieces())) {}

void WatchedMemory::ask(const memory::Transaction& transaction, bool write) {
  course_->ask(
      recorder_.request(site_.first_component + transaction.port, transaction, write, site_.engine.now()));
}

void WatchedMemory::read(const memory::Transaction& transaction) {
  ask(transaction, false);
  next().read(transaction);
  course_->settle();
}

void WatchedMemory::write(const memory::Transaction& transaction) {
  ask(transaction, true);
  next().write(transaction);
  course_->settle();
}

void WatchedMemory::reply(std::uint32_t port) {
  next().reply(port);
  course_->settle();
}

void WatchedMemory::proceed(std::uint32_t port, std::uint32_t sequence) {
  course_->proceed(port, sequence);
  next().proceed(port, sequence);
  course_->settle();
}

void WatchedMemory::read_done(std::uint32_t port, const memory::Service& service) {
  PathTip done = course_->read_done(port);
  sim::ensure(done.end() == service.done, "a read is not done at the end of its recorded course");
  recorder_.read_done(site_.first_component + port, std::move(done));
  site_.client.read_done(port, service);
}

void WatchedMemory::write_done(std::uint32_t port, sim::Ticks done) {
  PathTip tip = course_->write_done(port);
  sim::ensure(tip.end() == done, "a write is not done at the end of its recorded course");
  recorder_.write_done(site_.first_component + port, std::move(tip));
  site_.client.write_done(port, done);
}

}  // namespace marti::processors::path
