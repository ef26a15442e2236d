#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "sw/explore/store/database.h"
#include "sw/files/output_file.h"
#include "sw/trace/slot_places.h"
#include "sw/trace/trace_board.h"
#include "sw/trace/trace_writer.h"

namespace stereotlm::trace {

// Writes a trace as an SQLite database. Its schema says what each table and each column holds; README.md has
// queries.
class SqliteWriter : public TraceWriter {
 public:
  SqliteWriter(const std::filesystem::path& path, const platform::BoardConfig& board);

  void cycle(const fpga::CoreCycle& cycle) override;
  void burst(const platform::BusBurst& burst) override;
  void level(const platform::QueueLevel& level) override;
  void frame(const platform::FrameRuns& frame) override;
  void events(const platform::TimelineRecords& records) override;
  void complete(const TimeSpan& window) override;
  void commit() override;

 private:
  // The cycles in which a port has waited for its next access.
  struct Waited {
    std::uint64_t cycles = 0;
    std::size_t by = 0;  // in the last of them
  };

  void add_run(const platform::FrameRuns& frame, const platform::TraceRun& run, std::size_t last_strip);
  void add_transaction(const fpga::CoreCycle& cycle, std::size_t port);

  TraceBoard board_;
  SlotPlaces places_;
  files::OutputFile file_;
  std::optional<explore::Database> database_;
  std::optional<explore::Statement> run_, transaction_, burst_, level_, event_;
  std::array<Waited, fpga::kPortCount> waited_{};  // [port]
  std::uint64_t last_cycle_ = 0;                   // of cycle()
};

}  // namespace stereotlm::trace
