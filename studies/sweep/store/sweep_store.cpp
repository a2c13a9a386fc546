#include "studies/sweep/store/sweep_store.h"

#include <fmt/chrono.h>
#include <unistd.h>

#include <array>
#include <ctime>
#include <optional>
#include <unordered_set>

#include "sim/error.h"
#include "studies/sweep/store/store_lock.h"
#include "studies/sweep/store/store_plan.h"
#include "studies/sweep/store/store_rows.h"
#include "studies/sweep/store/store_schema.h"
#include "studies/sweep/store/store_sums.h"
#include "studies/tables/provenance.h"

namespace marti::studies {

namespace {

std::string now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

// Checks what can be checked without SQLite, which must not touch a file that is not a store.
const std::filesystem::path& checked(const std::filesystem::path& file) {
  check_store_file(file);
  return file;
}

}  // namespace

class SweepStore::Implementation {
 public:
  Implementation(const std::filesystem::path& file, const SweepPlan& plan)
      : lock_(file), connection_(checked(file), SqliteConnection::Access::write) {
    const bool is_new = is_empty_database(connection_);
    if (!is_new) {
      const std::int64_t format = check_store_format(connection_, file);
      check_store_version(connection_, file);
      check_whole(connection_, file, format);
    }
    begin_log();
    SqliteTransaction transaction(connection_);
    if (is_new) {
      create_store(connection_);
    }
    ids_ = enter_plan(connection_, plan);
    seal_plan(connection_);
    begin_session();
    transaction.commit();
    rows_.emplace(connection_);
  }

  [[nodiscard]] std::vector<bool> machines_done() {
    return done("SELECT machine FROM results", ids_.machines);
  }
  [[nodiscard]] std::vector<bool> frames_done() {
    return done("SELECT frame FROM frame_results", ids_.frames);
  }

  void add(std::size_t frame, const FrameRow& row, std::int64_t nanoseconds) {
    const std::int64_t id = ids_.frames.at(frame);
    if (rows_->has_frame(id)) {
      sim::ensure(RowReader(connection_).find_frame(id) == row, "the same frame has given two results");
      return;
    }
    add_with_cost(id, row, "host_frames", nanoseconds);
  }

  void add(std::size_t machine, const SweepRow& row, std::int64_t nanoseconds) {
    const std::int64_t id = ids_.machines.at(machine);
    if (rows_->has_machine(id)) {
      sim::ensure(RowReader(connection_).find_machine(id) == row, "the same machine has given two results");
      return;
    }
    add_with_cost(id, row, "host_machines", nanoseconds);
  }

  void close() {
    rows_.reset();
    SqliteStatement end(connection_, "UPDATE host_sessions SET ended = ? WHERE id = ?");
    const std::string ended = now();
    end.bind(1, std::string_view(ended)).bind(2, session_).run();
    connection_.execute("PRAGMA wal_checkpoint(TRUNCATE)");
    // Ends the log, without a journal, as begin_log() does. If a reader still needs the log, it stays, and
    // the next to open and close the store ends it.
    try {
      connection_.execute("PRAGMA busy_timeout = 0; PRAGMA journal_mode = OFF");
    } catch (const sim::UserError&) {
      return;
    }
  }

 private:
  // Commits in the log survive the end of the program; only a power cut may lose the last ones. Switching to
  // a log and back changes two bytes of the first page, by one write of one sector. No journal of SQLite's is
  // used for it: if the program were killed in between, the journal would stand in the way of readers.
  void begin_log() {
    if (connection_.value("PRAGMA journal_mode") != Cell("wal")) {
      connection_.execute("PRAGMA journal_mode = OFF; PRAGMA journal_mode = WAL");
    }
    connection_.execute("PRAGMA synchronous = NORMAL");
  }

  [[nodiscard]] std::vector<bool> done(const std::string& query, const std::vector<std::int64_t>& ids) {
    std::unordered_set<std::int64_t> there;
    SqliteStatement rows(connection_, query);
    while (rows.next()) {
      there.insert(rows.integer(0));
    }
    std::vector<bool> result;
    result.reserve(ids.size());
    for (const std::int64_t id : ids) {
      result.push_back(there.contains(id));
    }
    return result;
  }

  template <class Row>
  void add_with_cost(std::int64_t id, const Row& row, const std::string& costs, std::int64_t nanoseconds) {
    SqliteTransaction transaction(connection_);
    rows_->add(id, row);
    SqliteStatement cost(connection_, "INSERT INTO " + costs + " VALUES (?, ?, ?)");
    cost.bind(1, id).bind(2, session_).bind(3, nanoseconds).run();
    transaction.commit();
  }

  void begin_session() {
    const Table host = host_table();
    const auto property = [&](std::string_view what) {
      for (const std::vector<Cell>& row : host.rows()) {
        if (std::get<std::string>(row[0]) == what) {
          return std::get<std::string>(row[1]);
        }
      }
      return std::string("unknown");
    };
    session_ = connection_.integer("SELECT COALESCE(MAX(id), 0) + 1 FROM host_sessions");
    SqliteStatement session(connection_, "INSERT INTO host_sessions VALUES (?, ?, NULL, ?, ?, ?, ?, ?)");
    const std::string began = now();
    const std::string name = host_name();
    const std::string processor = property("processor");
    const std::string system = property("system");
    const std::string threads = property("threads");
    session.bind(1, session_).bind(2, std::string_view(began)).bind(3, std::string_view(name));
    session.bind(4, std::int64_t{getpid()}).bind(5, std::string_view(processor));
    session.bind(6, std::string_view(system)).bind(7, std::string_view(threads)).run();
  }

  StoreLock lock_;  // outlives the connection
  SqliteConnection connection_;
  std::optional<RowWriter> rows_;  // made once the tables exist
  StoreIds ids_;
  std::int64_t session_ = 0;
};

SweepStore::SweepStore(const std::filesystem::path& file, const SweepPlan& plan)
    : implementation_(std::make_unique<Implementation>(file, plan)) {}

SweepStore::~SweepStore() = default;

std::vector<bool> SweepStore::done() const { return implementation_->machines_done(); }

std::vector<bool> SweepStore::frames_done() const { return implementation_->frames_done(); }

void SweepStore::add_frame(std::size_t frame, const FrameRow& row, std::int64_t cpu_nanoseconds) {
  implementation_->add(frame, row, cpu_nanoseconds);
}

void SweepStore::add_result(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds) {
  implementation_->add(machine, row, cpu_nanoseconds);
}

void SweepStore::close() {
  implementation_->close();
  implementation_.reset();
}

}  // namespace marti::studies
