#include "platform/conflicts.h"

#include <numeric>
#include <utility>

#include "platform/audit.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

const char* port_name(std::size_t requester) {
  return requester == fpga::kTurnaroundToBlame ? fpga::requester_name(requester)
                                               : fpga::kPorts[fpga::port_of_requester(requester)].name;
}

// The buffers that the capture boards write to.
std::vector<AddressRange> captured(const BoardConfig& board) {
  std::vector<AddressRange> ranges;
  if (board.capture.destination != CaptureDestination::kBoard) return ranges;
  const std::vector<PlacedBuffer> placed = buffers(board);
  const std::vector<AddressRange> all = buffer_ranges(board);
  for (std::size_t index = 0; index < placed.size(); ++index) {
    if (placed[index].buffer == Buffer::kLeftImage || placed[index].buffer == Buffer::kRightImage)
      ranges.push_back(all[index]);
  }
  return ranges;
}

}  // namespace

Conflicts::Conflicts(const BoardConfig& board, std::size_t most_tiles)
    : recorder_(core_config(board), ssram_configs(board), captured(board), most_tiles),
      accesses_(board.banks.size()) {}

std::vector<fpga::FrameConflicts> Conflicts::take_frames() {
  std::vector<fpga::FrameConflicts> frames = recorder_.take_frames();
  for (const fpga::FrameConflicts& frame : frames) {
    ++frames_;
    for (const fpga::StripConflicts& strip : frame.strips) {
      cycles_ += strip.cycles;
      for (std::size_t requester = 0; requester < stalls_.size(); ++requester)
        stalls_[requester] += strip.stalls[requester];
    }
    for (std::size_t place = 0; place < frame.accesses.size(); ++place) {
      const auto& of_bank = frame.accesses[place];
      std::uint64_t& accesses = accesses_[place % frame.banks];
      accesses = std::accumulate(of_bank.begin(), of_bank.end(), accesses);
    }
  }
  return frames;
}

std::vector<std::string> Conflicts::failed(const Statistics& statistics) const {
  Audit audit;
  audit.equal("recorded: frames with rows", frames_, "frames", statistics.frames);
  audit.equal("recorded: frames in tiles", recorder_.frames(), "frames", statistics.frames);
  audit.equal("recorded: cycles of the rows", cycles_, "cycles", statistics.cycles);
  const std::vector<std::uint64_t> tiles = recorder_.tile_cycles();
  audit.equal("recorded: cycles of the tiles", std::accumulate(tiles.begin(), tiles.end(), std::uint64_t{0}),
              "cycles", statistics.cycles);
  std::array<std::uint64_t, fpga::kPortCount> stalls{};
  for (std::size_t requester = 0; requester < stalls_.size(); ++requester)
    stalls[fpga::port_of_requester(requester)] += stalls_[requester];
  for (std::size_t port = 0; port < stalls.size(); ++port) {
    audit.equal("recorded: port " + statistics.ports[port].name + ": stalls in the rows", stalls[port],
                "stall_cycles", statistics.ports[port].stall_cycles);
  }
  for (std::size_t bank = 0; bank < accesses_.size(); ++bank) {
    const BankStatistics& of_bank = statistics.banks[bank];
    audit.equal("recorded: bank " + of_bank.name + ": accesses in the rows", accesses_[bank],
                "reads + writes", of_bank.reads + of_bank.writes);
  }
  std::uint64_t blamed = 0;
  std::uint64_t in_tiles = 0;
  for (const BlameRow& row : statistics.blame) {
    std::uint64_t cycles = 0;
    for (const fpga::ConflictRecorder::Stalls* each : recorder_.stalls()) {
      if (port_name(each->requester) == row.port && statistics.banks[each->bank].name == row.bank &&
          port_name(each->by) == row.by)
        cycles = std::accumulate(each->cycles.begin(), each->cycles.end(), cycles);
    }
    audit.equal(
        "recorded: " + row.port + " on " + row.bank + " because of " + row.by + ": stalls in the tiles",
        cycles, "blame", row.cycles);
    blamed += row.cycles;
  }
  for (const fpga::ConflictRecorder::Stalls* each : recorder_.stalls())
    in_tiles = std::accumulate(each->cycles.begin(), each->cycles.end(), in_tiles);
  audit.equal("recorded: stalls in the tiles", in_tiles, "sum of blame", blamed);
  return std::move(audit).failed();
}

}  // namespace stereotlm::platform
