#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/sqlite/database.h"
#include "sw/trace/trace_board.h"
#include "sw/trace/trace_sink.h"

namespace stereotlm::trace {
namespace {

constexpr int kApplicationId = 0x53544C54;  // "STLT"; that of a database of sweep is another

// The database is known by its header, which has the application id at byte 68.
files::FileKind database_kind() {
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

// An INSERT into a table. Texts must outlive the call of row().
class Insertion {
 public:
  Insertion(const sqlite::Database& database, const std::string& table, std::size_t columns)
      : statement_(database, fmt::format("INSERT INTO {} VALUES ({})", table,
                                         fmt::join(std::vector<std::string>(columns, "?"), ","))) {}

  template <typename... Values>
  void row(const Values&... values) {
    int place = 0;
    (bind(++place, values), ...);
    statement_.run();
  }

 private:
  void bind(int place, const std::optional<std::uint64_t>& number) {
    if (number)
      sqlite3_bind_int64(statement_.handle(), place, static_cast<sqlite3_int64>(*number));
    else
      sqlite3_bind_null(statement_.handle(), place);
  }
  // A null pointer is NULL.
  void bind(int place, const char* text) {
    sqlite3_bind_text(statement_.handle(), place, text, -1, SQLITE_STATIC);
  }
  void bind(int place, const std::string& text) { bind(place, text.c_str()); }

  sqlite::Statement statement_;
};

// The database and its tables. The statements end before the database is closed.
struct Tables {
  explicit Tables(files::OutputFile& file, const std::string& path)
      : database(file.unfinished().string(), sqlite::Database::Access::kWrite, sqlite::Database::kBusyTimeout,
                 path) {
    // Nobody reads the file before it is complete, and then it replaces the earlier one.
    database.execute("PRAGMA journal_mode=OFF");
    database.execute("PRAGMA synchronous=OFF");
    database.execute("PRAGMA locking_mode=EXCLUSIVE");
    database.execute(fmt::format("PRAGMA application_id={}", kApplicationId));
    database.execute("BEGIN");
    database.execute(kSchema);
    runs.emplace(database, "runs", 10);
    transactions.emplace(database, "transactions", 11);
    bursts.emplace(database, "bursts", 10);
    levels.emplace(database, "levels", 3);
    events.emplace(database, "events", 9);
  }

  sqlite::Database database;
  std::optional<Insertion> runs, transactions, bursts, levels, events;
};

class SqliteSink : public TraceSink {
 public:
  SqliteSink(const std::filesystem::path& path, const platform::BoardConfig& board) : board_(board) {
    files_.emplace_back(path, database_kind());
    tables_.emplace(files_.front(), path.string());
    Insertion meta(tables_->database, "meta", 2);
    meta.row("board", board.name);
    meta.row("clock_mhz", fmt::format("{}", board.fpga.clock_mhz));
    meta.row("config_yaml", platform::to_yaml(board));
  }

  // Strips that follow each other and count the same become one run.
  void frame(const platform::FrameRuns& frame) override {
    struct Open {
      const platform::TraceRun* first;
      std::size_t last_strip;

      bool has_place_of(const platform::TraceRun& run) const {
        return std::tie(first->requester, first->bank, first->by) ==
               std::tie(run.requester, run.bank, run.by);
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

  void cycle(const fpga::CoreCycle& cycle) override {
    if (cycle.cycle != last_cycle_ + 1) waited_.assign(waited_.size(), {});
    last_cycle_ = cycle.cycle;
    for (std::size_t port = 0; port < waited_.size(); ++port) {
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

  void burst(const platform::BusBurst& burst) override {
    tables_->bursts->row(burst.bus == platform::BusBurst::Bus::kPci ? "pci" : "local", burst.master,
                         burst.target, burst.write, burst.address, burst.words, burst.request_ps,
                         burst.address_ps, burst.data_ps, burst.end_ps);
  }

  void level(const platform::QueueLevel& level) override {
    tables_->levels->row(level.queue, level.time_ps, level.words);
  }

  void event(const platform::TimelineEvent& event) override {
    tables_->events->row(platform::kEventKindNames[static_cast<std::size_t>(event.kind)], event.what,
                         event.frame, event.camera_frame, event.begin_ps, event.end_ps, event.words,
                         event.dropped_pixels, *event.why != '\0' ? event.why : nullptr);
  }

  void end(const TimeSpan& /*window*/) override {
    tables_->database.execute("COMMIT");
    tables_.reset();
  }

 private:
  // The cycles in which a port has waited for its next access.
  struct Waited {
    std::uint64_t cycles = 0;
    std::size_t by = 0;  // in the last of them
  };

  void add_run(const platform::FrameRuns& frame, const platform::TraceRun& run, std::size_t last_strip) {
    const auto rows = static_cast<std::size_t>(board_.geometry.rows);
    std::optional<std::uint64_t> first_row;
    std::uint64_t count_of_rows = 0;
    if (run.strip != 0) {
      first_row = (run.strip - 1) * rows;
      count_of_rows =
          std::min(last_strip * rows, static_cast<std::size_t>(board_.geometry.height)) - *first_row;
    }
    tables_->runs->row(frame.frame, first_row, count_of_rows, run.first_cycle, frame.strip_ends[last_strip],
                       board_.requester_names[run.requester], board_.bank_name(run.bank),
                       run.by ? "wait" : "grant", run.by ? board_.requester_names[*run.by].c_str() : nullptr,
                       run.count * (last_strip - run.strip + 1));
  }

  void add_transaction(const fpga::CoreCycle& cycle, std::size_t port) {
    const fpga::PortCycle& access = cycle.ports[port];
    const std::size_t requester = board_.requesters.of_port(port, cycle.host_traffic);
    std::array<std::optional<std::uint64_t>, 3> item;  // and its row and column
    if (port != board_.ports().host()) {
      const SlotPlace place = board_.place_of(port, access.item);
      item = {access.item, static_cast<std::uint64_t>(place.row), static_cast<std::uint64_t>(place.column)};
    }
    const Waited& waited = waited_[port];
    tables_->transactions->row(
        cycle.frame, cycle.cycle, board_.requester_names[requester], board_.bank_name(access.bank),
        board_.requesters.writes(requester), access.address, waited.cycles,
        waited.cycles != 0 ? board_.requester_names[waited.by].c_str() : nullptr, item[0], item[1], item[2]);
  }

  TraceBoard board_;
  std::optional<Tables> tables_;
  std::vector<Waited> waited_ = std::vector<Waited>(board_.ports().size());  // [port]
  std::uint64_t last_cycle_ = 0;                                             // of cycle()
};

}  // namespace

std::unique_ptr<TraceSink> sqlite_sink(const std::filesystem::path& path,
                                       const platform::BoardConfig& board) {
  return std::make_unique<SqliteSink>(path, board);
}

}  // namespace stereotlm::trace
