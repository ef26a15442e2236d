#include "platform/records/conflicts.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "platform/config/board_keys.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

std::string port_name(const fpga::Requesters& requesters, std::size_t requester) {
  return requesters.is_requester(requester) ? requesters.ports().name(requesters.port_of(requester))
                                            : requesters.name(requester);
}

// The buffers that the capture boards write to.
std::vector<AddressRange> captured(const BoardConfig& board) {
  std::vector<AddressRange> ranges;
  if (board.capture.destination != CaptureDestination::kBoard) return ranges;
  for (const PlacedBuffer& placed : buffers(board)) {
    if (placed.buffer == Buffer::kLeftImage || placed.buffer == Buffer::kRightImage)
      ranges.push_back(placed.range);
  }
  return ranges;
}

}  // namespace

void ConflictSums::check_rows(const fpga::Requesters& requesters, const Statistics& statistics,
                              Audit& audit) const {
  audit.equal("recorded: frames with rows", frames, "frames", statistics.frames);
  audit.equal("recorded: cycles of the rows", cycles, "cycles", statistics.cycles);
  std::vector<std::uint64_t> of_ports(requesters.ports().size());
  for (std::size_t requester = 0; requester < stalls.size(); ++requester)
    of_ports[requesters.port_of(requester)] += stalls[requester];
  for (std::size_t port = 0; port < of_ports.size(); ++port) {
    audit.equal("recorded: port " + statistics.ports[port].name + ": stalls in the rows", of_ports[port],
                "stall_cycles", statistics.ports[port].stall_cycles);
  }
  for (std::size_t bank = 0; bank < accesses.size(); ++bank) {
    const BankStatistics& of_bank = statistics.banks[bank];
    audit.equal("recorded: bank " + of_bank.name + ": accesses in the rows", accesses[bank], "reads + writes",
                of_bank.reads + of_bank.writes);
  }
}

void ConflictSums::check_tiles(const fpga::Requesters& requesters, const Statistics& statistics,
                               Audit& audit) const {
  std::uint64_t blamed = 0;
  std::uint64_t in_tiles = 0;
  for (const BlameRow& row : statistics.blame) {
    std::uint64_t cycles_of_row = 0;
    for (const auto& [cause, stalled] : blame) {
      if (port_name(requesters, cause[0]) == row.port && statistics.banks[cause[1]].name == row.bank &&
          port_name(requesters, cause[2]) == row.by)
        cycles_of_row += stalled;
    }
    audit.equal("recorded: " + row.port + " on " + bank_text(row.bank) + " because of " + row.by +
                    ": stalls in the tiles",
                cycles_of_row, "blame", row.cycles);
    blamed += row.cycles;
  }
  for (const auto& [cause, stalled] : blame) in_tiles += stalled;
  audit.equal("recorded: stalls in the tiles", in_tiles, "sum of blame", blamed);
}

Conflicts::Conflicts(const BoardConfig& board, std::size_t most_tiles)
    : recorder_(core_config(board), ssram_configs(board), captured(board), most_tiles) {
  sums_.accesses.resize(board.banks.size());
  sums_.stalls.resize(recorder_.requesters().size());
}

std::vector<fpga::FrameConflicts> Conflicts::take_frames() {
  std::vector<fpga::FrameConflicts> frames = recorder_.take_frames();
  for (const fpga::FrameConflicts& frame : frames) {
    ++sums_.frames;
    for (const fpga::StripConflicts& strip : frame.strips) {
      sums_.cycles += strip.cycles;
      for (std::size_t requester = 0; requester < sums_.stalls.size(); ++requester)
        sums_.stalls[requester] += strip.stalls[requester];
    }
    for (std::size_t place = 0; place < frame.accesses.size(); ++place) {
      const auto& of_bank = frame.accesses[place];
      std::uint64_t& accesses = sums_.accesses[place % frame.banks];
      accesses = std::accumulate(of_bank.begin(), of_bank.end(), accesses);
    }
  }
  return frames;
}

std::vector<std::string> Conflicts::failed(const Statistics& statistics) const {
  Audit audit;
  audit.equal("recorded: frames in tiles", recorder_.frames(), "frames", statistics.frames);
  const std::vector<std::uint64_t> tiles = recorder_.tile_cycles();
  audit.equal("recorded: cycles of the tiles", std::accumulate(tiles.begin(), tiles.end(), std::uint64_t{0}),
              "cycles", statistics.cycles);
  sums_.check_rows(recorder_.requesters(), statistics, audit);
  ConflictSums sums;
  for (const fpga::ConflictRecorder::Stalls* each : recorder_.stalls()) {
    sums.blame[{each->requester, each->bank, each->by}] =
        std::accumulate(each->cycles.begin(), each->cycles.end(), std::uint64_t{0});
  }
  sums.check_tiles(recorder_.requesters(), statistics, audit);
  return audit.failed();
}

FrameRuns frame_runs(const fpga::FrameConflicts& frame) {
  const std::size_t first_of_host = frame.strips.front().stalls.size() - fpga::kHostTraffics;
  FrameRuns result;
  result.frame = frame.number;
  result.first_cycle = result.end_cycle = frame.first_cycle;
  for (const fpga::StripConflicts& strip : frame.strips)
    result.strip_ends.push_back(result.end_cycle += strip.cycles);

  const auto add = [&result](std::size_t strip, std::size_t requester, std::size_t bank,
                             std::optional<std::size_t> by, std::uint64_t count) {
    if (count == 0) return;
    const std::uint64_t first = strip == 0 ? result.first_cycle : result.strip_ends[strip - 1];
    result.runs.push_back({strip, first, result.strip_ends[strip], requester, bank, by, count});
  };
  for (std::size_t strip = 0; strip < frame.strips.size(); ++strip) {
    for (const auto& [port, bank, cycles] : frame.strips[strip].grants)
      add(strip, port, bank, std::nullopt, cycles);
    for (std::size_t bank = 0; bank < frame.banks; ++bank) {
      const auto& accesses = frame.accesses[strip * frame.banks + bank];
      for (std::size_t traffic = 0; traffic < fpga::kHostTraffics; ++traffic)
        add(strip, first_of_host + traffic, bank, std::nullopt, accesses[1 + traffic]);
    }
  }
  for (const fpga::FrameConflicts::Stalls& stalls : frame.stalls) {
    const fpga::StallCause& cause = frame.causes[stalls.cause];
    add(stalls.strip, cause.requester, cause.bank, cause.by, stalls.cycles);
  }
  // Grants come first, because nothing is less than everything.
  std::sort(result.runs.begin(), result.runs.end(), [](const TraceRun& a, const TraceRun& b) {
    return std::tie(a.strip, a.requester, a.bank, a.by) < std::tie(b.strip, b.requester, b.bank, b.by);
  });
  return result;
}

}  // namespace stereotlm::platform
