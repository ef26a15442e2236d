#include "sw/trace/sqlite_writer.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "platform/config/board_yaml.h"

namespace stereotlm::trace {
namespace {

constexpr int kApplicationId = 0x53544C54;  // "STLT"; that of a database of sweep is another

// The database is known by its header, which has the application id at byte 68.
files::FileKind kind() {
  using namespace std::string_literals;
  files::FileKind kind = files::marked_kind("trace of stereotlm", {{0, "SQLite format 3\0"s}, {68, "STLT"}});
  kind.journals = {"-journal", "-wal"};
  return kind;
}

// SQLite keeps the text of these statements in the file, with its comments.
constexpr const char* kSchema = R"(
CREATE TABLE meta (
  key   TEXT PRIMARY KEY, -- board, clock_mhz, config_yaml
  value TEXT NOT NULL
);
CREATE TABLE runs ( -- what each port does at each bank, in rows that follow each other
  frame INTEGER NOT NULL, -- of the core, from 0
  row   INTEGER,          -- the first row of results; NULL: the cycles before the first results (the fill)
  rows  INTEGER NOT NULL, -- the number of rows, over which the count is uniform; 0: the fill
  start INTEGER NOT NULL, -- the first cycle of these rows; cycles of the FPGA clock count from power-up
  "end" INTEGER NOT NULL, -- the first cycle behind them
  port  TEXT NOT NULL,    -- left_lut, .., result, host capture, host upload, host read-back
  bank  TEXT NOT NULL,
  kind  TEXT NOT NULL,    -- grant: the port gets an access; wait: it requests and does not get it
  by    TEXT,             -- of a wait: the port that is granted instead, or turnaround
  count INTEGER NOT NULL  -- the number of such cycles in all these rows
);
CREATE TABLE transactions ( -- each access of a bank in the window
  frame   INTEGER,          -- that runs; NULL: none
  cycle   INTEGER NOT NULL, -- in which it is granted
  port    TEXT NOT NULL,
  bank    TEXT NOT NULL,
  write   INTEGER NOT NULL, -- 1: write, 0: read
  address INTEGER NOT NULL, -- byte address in the bank
  waited  INTEGER NOT NULL, -- cycles of the window in which the port waited for it
  by      TEXT,             -- for whom in the last of them; NULL: it did not wait
  item    INTEGER,          -- number in the frame of the slot (a read) or of the word (a result)
  row     INTEGER,          -- place in the picture of the slot, or of the first disparity of the word
  "column" INTEGER
);
CREATE TABLE bursts ( -- on the PCI bus and on the local bus, in the window; times in ps since power-up
  bus        TEXT NOT NULL,    -- pci, local
  master     TEXT NOT NULL,
  target     TEXT NOT NULL,
  write      INTEGER NOT NULL, -- 1: write, 0: read
  address    INTEGER NOT NULL, -- byte address on the bus
  words      INTEGER NOT NULL,
  request_ps INTEGER NOT NULL, -- the first clock that could be granted begins
  address_ps INTEGER NOT NULL, -- the address clock begins
  data_ps    INTEGER NOT NULL, -- the address clock ends
  end_ps     INTEGER NOT NULL  -- the last data clock ends
);
CREATE TABLE levels ( -- words in the queues around the core, in the window
  queue   TEXT NOT NULL, -- left_capture, right_capture, posted
  time_ps INTEGER NOT NULL,
  words   INTEGER NOT NULL
);
CREATE TABLE events ( -- what happens in the computer
  kind           TEXT NOT NULL, -- capture, drop, upload, read_back, frame, interrupt, wait
  what           TEXT NOT NULL,
  frame          INTEGER,
  camera_frame   INTEGER,
  begin_ps       INTEGER NOT NULL,
  end_ps         INTEGER NOT NULL,
  words          INTEGER NOT NULL,
  dropped_pixels INTEGER NOT NULL,
  why            TEXT -- of a drop or a wait
);
)";

std::string insert(const char* table, int columns) {
  std::string places = "?";
  for (int column = 1; column < columns; ++column) places += ",?";
  return fmt::format("INSERT INTO {} VALUES ({})", table, places);
}

// Binds the parameters of a statement one after the other, and runs it. Texts must outlive run().
class Row {
 public:
  explicit Row(explore::Statement& statement) : statement_(statement) {}

  Row& number(std::uint64_t value) {
    sqlite3_bind_int64(statement_.handle(), ++place_, static_cast<sqlite3_int64>(value));
    return *this;
  }
  Row& text(const char* value) {
    sqlite3_bind_text(statement_.handle(), ++place_, value, -1, SQLITE_STATIC);
    return *this;
  }
  Row& null() {
    sqlite3_bind_null(statement_.handle(), ++place_);
    return *this;
  }
  Row& number(const std::optional<std::uint64_t>& value) { return value ? number(*value) : null(); }
  void run() { statement_.run(); }

 private:
  explore::Statement& statement_;
  int place_ = 0;
};

}  // namespace

SqliteWriter::SqliteWriter(const std::filesystem::path& path, const platform::BoardConfig& board)
    : board_(board), places_(board_.geometry), file_(path, kind()) {
  database_.emplace(file_.aside().path().string(), explore::Database::Access::kWrite,
                    explore::Database::kBusyTimeout, path.string());
  // Nobody reads the file before it is complete, and then it replaces the earlier one.
  database_->execute("PRAGMA journal_mode=OFF");
  database_->execute("PRAGMA synchronous=OFF");
  database_->execute("PRAGMA locking_mode=EXCLUSIVE");
  database_->execute(fmt::format("PRAGMA application_id={}", kApplicationId));
  database_->execute("BEGIN");
  database_->execute(kSchema);
  explore::Statement meta(*database_, insert("meta", 2));
  for (const auto& [key, value] : {std::pair<const char*, std::string>("board", board.name),
                                   {"clock_mhz", fmt::format("{}", board.fpga.clock_mhz)},
                                   {"config_yaml", platform::to_yaml(board)}})
    Row(meta).text(key).text(value.c_str()).run();
  run_.emplace(*database_, insert("runs", 10));
  transaction_.emplace(*database_, insert("transactions", 11));
  burst_.emplace(*database_, insert("bursts", 10));
  level_.emplace(*database_, insert("levels", 3));
  event_.emplace(*database_, insert("events", 9));
}

// Strips that follow each other and count the same become one run.
void SqliteWriter::frame(const platform::FrameRuns& frame) {
  struct Open {
    const platform::TraceRun* first;
    std::size_t last_strip;

    bool has_place_of(const platform::TraceRun& run) const {
      return std::tie(first->requester, first->bank, first->by) == std::tie(run.requester, run.bank, run.by);
    }
    bool is_continued_by(const platform::TraceRun& run) const {
      return first->strip != 0 && last_strip + 1 == run.strip && first->count == run.count;
    }
  };
  const std::size_t strips = frame.strip_ends.size();
  const bool last_has_fewer_rows = board_.geometry.last_rows != board_.geometry.rows;
  std::vector<Open> open;
  for (const platform::TraceRun& run : frame.runs) {
    const auto found =
        std::find_if(open.begin(), open.end(), [&run](const Open& each) { return each.has_place_of(run); });
    if (found == open.end()) {
      open.push_back({&run, run.strip});
    } else if (found->is_continued_by(run) && !(last_has_fewer_rows && run.strip + 1 == strips)) {
      found->last_strip = run.strip;
    } else {
      add_run(frame, *found->first, found->last_strip);
      *found = {&run, run.strip};
    }
  }
  for (const Open& each : open) add_run(frame, *each.first, each.last_strip);
}

void SqliteWriter::add_run(const platform::FrameRuns& frame, const platform::TraceRun& run,
                           std::size_t last_strip) {
  const auto rows = static_cast<std::size_t>(board_.geometry.rows);
  Row row(*run_);
  row.number(frame.frame);
  if (run.strip == 0) {
    row.null().number(0);
  } else {
    const std::size_t first_row = (run.strip - 1) * rows;
    row.number(first_row).number(
        std::min(last_strip * rows, static_cast<std::size_t>(board_.geometry.height)) - first_row);
  }
  row.number(run.first_cycle)
      .number(frame.strip_ends[last_strip])
      .text(fpga::requester_name(run.requester))
      .text(board_.bank_name(run.bank).c_str())
      .text(run.by ? "wait" : "grant");
  run.by ? row.text(fpga::requester_name(*run.by)) : row.null();
  row.number(run.count * (last_strip - run.strip + 1)).run();
}

void SqliteWriter::cycle(const fpga::CoreCycle& cycle) {
  if (cycle.cycle != last_cycle_ + 1) waited_ = {};
  last_cycle_ = cycle.cycle;
  for (std::size_t port = 0; port < fpga::kPortCount; ++port) {
    const fpga::PortCycle& of_port = cycle.ports[port];
    const bool requests = of_port.intent == fpga::Intent::kRequest;
    if (requests && !of_port.granted) {
      waited_[port] = {waited_[port].cycles + 1, of_port.by};
      continue;
    }
    if (requests) add_transaction(cycle, port);
    waited_[port] = {};
  }
}

void SqliteWriter::add_transaction(const fpga::CoreCycle& cycle, std::size_t port) {
  const fpga::PortCycle& access = cycle.ports[port];
  const bool is_host = port == fpga::kHostPort;
  Row row(*transaction_);
  row.number(cycle.frame)
      .number(cycle.cycle)
      .text(fpga::requester_name(requester_of_port(port, cycle.host_traffic)))
      .text(board_.bank_name(access.bank).c_str())
      .number(writes(requester_of_port(port, cycle.host_traffic)))
      .number(access.address)
      .number(waited_[port].cycles);
  waited_[port].cycles != 0 ? row.text(fpga::requester_name(waited_[port].by)) : row.null();
  if (is_host) {
    row.null().null().null();
  } else {
    const bool is_result = port == fpga::kResultPort;
    const SlotPlace place = is_result ? places_.place_of_word(access.item) : places_.place(access.item);
    row.number(access.item)
        .number(static_cast<std::uint64_t>(place.row))
        .number(static_cast<std::uint64_t>(place.column));
  }
  row.run();
}

void SqliteWriter::burst(const platform::BusBurst& burst) {
  Row(*burst_)
      .text(burst.bus == platform::BusBurst::Bus::kPci ? "pci" : "local")
      .text(burst.master)
      .text(burst.target)
      .number(burst.write)
      .number(burst.address)
      .number(burst.words)
      .number(burst.request_ps)
      .number(burst.address_ps)
      .number(burst.data_ps)
      .number(burst.end_ps)
      .run();
}

void SqliteWriter::level(const platform::QueueLevel& level) {
  Row(*level_).text(level.queue).number(level.time_ps).number(level.words).run();
}

void SqliteWriter::events(const platform::TimelineRecords& records) {
  for (const platform::TimelineEvent& event : records.events) {
    Row row(*event_);
    row.text(platform::kEventKindNames[static_cast<std::size_t>(event.kind)])
        .text(event.what)
        .number(event.frame)
        .number(event.camera_frame)
        .number(event.begin_ps)
        .number(event.end_ps)
        .number(event.words)
        .number(event.dropped_pixels);
    *event.why != '\0' ? row.text(event.why).run() : row.null().run();
  }
}

void SqliteWriter::complete(const TimeSpan& /*window*/) {
  database_->execute("COMMIT");
  for (auto* statement : {&run_, &transaction_, &burst_, &level_, &event_}) statement->reset();
  database_.reset();
  file_.complete();
}

void SqliteWriter::commit() { file_.commit(); }

}  // namespace stereotlm::trace
