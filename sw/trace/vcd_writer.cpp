#include "sw/trace/vcd_writer.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string>

#include "models/memory/crossbar_address.h"
#include "sw/process/command.h"
#include "sw/trace/gtkwave_layout.h"

namespace stereotlm::trace {

namespace fs = std::filesystem;
using fpga::CoreCycle;
using fpga::PortCycle;
using platform::BusBurst;

namespace {

constexpr std::size_t kBusStreams = 2;
constexpr std::size_t kQueueStreams = 3;

// Returns the path, for which vcd2fst is needed if it ends in ".fst".
const fs::path& checked_path(const fs::path& path) {
  if (path.extension() == ".gtkw")
    throw std::runtime_error(fmt::format(
        "'{}': must not end in .gtkw: that is the file with the layout of the waveform", path.string()));
  if (!VcdWriter::is_fst(path)) return path;
  try {
    process::run_command({"vcd2fst", "--help"});
  } catch (const process::CommandMissing&) {
    throw std::runtime_error(fmt::format(
        "{}: FST is written by the program vcd2fst, which is not installed: install the package gtkwave, or "
        "give a path that ends in .vcd",
        path.string()));
  }
  return path;
}

files::FileKind kind_of(const fs::path& path) {
  using namespace std::string_literals;
  if (!VcdWriter::is_fst(path)) return files::marked_kind("waveform of stereotlm", {{0, kVcdMark}});
  // The kind and the length of the header, and in it the name of the writer, which fills its field.
  constexpr std::size_t kPlaceOfWriter = 74;
  constexpr std::size_t kBytesOfWriter = 128;
  std::string writer = "stereotlm";
  writer.resize(kBytesOfWriter);
  return files::marked_kind("waveform of stereotlm",
                            {{0, "\0\0\0\0\0\0\0\1\x49"s}, {kPlaceOfWriter, writer}});
}

files::FileKind layout_kind() {
  return files::marked_kind("layout of stereotlm", {{0, std::string(kLayoutMark) + "\n"}});
}

// Whether a file is there that GTKWave has saved, or somebody else.
bool is_of_user(const fs::path& layout) {
  std::error_code none;
  return fs::is_regular_file(layout, none) && fs::file_size(layout, none) > 0 &&
         !layout_kind().is_own(layout);
}

}  // namespace

VcdWriter::VcdWriter(const fs::path& path, const platform::BoardConfig& board)
    : path_(checked_path(path)),
      board_(board),
      signals_(board_),
      words_(make_words()),
      file_(path, kind_of(path)),
      core_(files::linked_file(path)) {
  if (!is_of_user(layout_of(path))) layout_.emplace(layout_of(path), layout_kind());
  for (std::size_t bus = 0; bus < kBusStreams; ++bus) buses_.emplace_back(files::linked_file(path));
  for (std::size_t queue = 0; queue < kQueueStreams; ++queue) queues_.emplace_back(files::linked_file(path));
  for (std::size_t signal = 0; signal < signals_.core_size(); ++signal)
    idle_.push_back(signals_.all()[signal].idle);
  shown_ = idle_;
}

VcdWriter::Words VcdWriter::make_words() {
  Words words{};
  words.accesses = {signals_.word("reads"), signals_.word("writes")};
  // In the order of fpga::Intent. A request that is not granted waits.
  words.intents = {signals_.word("waits"), signals_.word("passes"), signals_.word("idle"),
                   signals_.word("blocked"), signals_.word("starved")};
  for (std::size_t requester = 0; requester < words.requesters.size(); ++requester)
    words.requesters[requester] = signals_.word(fpga::requester_name(requester));
  for (const platform::BankConfig& bank : board_.banks) words.banks.push_back(signals_.word(bank.name));
  words.traffics = {signals_.word("capture"), signals_.word("upload"), signals_.word("read-back")};
  return words;
}

void VcdWriter::cycle(const CoreCycle& cycle) {
  if (next_cycle_ && *next_cycle_ != cycle.cycle) end_cycles();
  next_cycle_ = cycle.cycle + 1;
  show_idle();
  for (std::size_t port = 0; port < fpga::kPortCount; ++port) {
    if (signals_.port(port) != VcdSignals::kNone) show_port(cycle, port);
  }
  for (std::size_t side = 0; side < cycle.lane_slots.size(); ++side)
    now_[signals_.lane(side)] = cycle.lane_slots[side];
  now_[signals_.results()] = cycle.result_words;
  now_[signals_.works()] = cycle.works ? 1 : 0;
  add_changes(cycle.cycle);
}

// Bank and address of a port stay those of its last request, as on a bus, and so that a waveform has fewer changes.
void VcdWriter::show_idle() {
  now_ = idle_;
  for (std::size_t port = 0; port < fpga::kPortCount; ++port) {
    const std::size_t first = signals_.port(port);
    if (first == VcdSignals::kNone) continue;
    for (const std::size_t held : {first + VcdSignals::kBank, first + VcdSignals::kAddress})
      now_[held] = shown_[held];
  }
}

// The cycles that follow are left out, or behind the window.
void VcdWriter::end_cycles() {
  if (!next_cycle_) return;
  show_idle();
  add_changes(*next_cycle_);
  next_cycle_.reset();
}

void VcdWriter::show_port(const CoreCycle& cycle, std::size_t port) {
  const PortCycle& its = cycle.ports[port];
  std::uint32_t* const shown = now_.data() + signals_.port(port);
  shown[VcdSignals::kState] = words_.intents[static_cast<std::size_t>(its.intent)];
  if (its.intent != fpga::Intent::kRequest) return;
  const std::size_t requester = requester_of_port(port, cycle.host_traffic);
  if (its.granted)
    shown[VcdSignals::kState] = words_.accesses[writes(requester) ? 1 : 0];
  else
    shown[VcdSignals::kWaitsFor] = words_.requesters[its.by];
  shown[VcdSignals::kBank] = words_.banks[its.bank];
  shown[VcdSignals::kAddress] = static_cast<std::uint32_t>(its.address);
  if (port == fpga::kHostPort)
    now_[signals_.host_traffic()] = words_.traffics[static_cast<std::size_t>(cycle.host_traffic)];
  show_bank(its, requester);
}

void VcdWriter::show_bank(const PortCycle& port, std::size_t requester) {
  std::uint32_t* const bank = now_.data() + signals_.bank(port.bank);
  ++bank[VcdSignals::kRequests];
  const bool is_second = board_.has_separate_ports(port.bank) && writes(requester);
  std::uint32_t& owner = bank[is_second ? VcdSignals::kWriteOwner : VcdSignals::kOwner];
  if (port.granted)
    owner = words_.requesters[requester];
  else if (port.by == fpga::kTurnaroundToBlame)
    owner = words_.requesters[port.by];
}

void VcdWriter::add_changes(std::uint64_t cycle) {
  const std::uint64_t time_ps = board_.ps(cycle);
  for (std::uint32_t signal = 0; signal < now_.size(); ++signal) {
    if (now_[signal] != shown_[signal]) core_.add(time_ps, signal, now_[signal]);
  }
  std::swap(shown_, now_);
}

void VcdWriter::burst(const BusBurst& burst) {
  ChangeStream& stream = buses_[static_cast<std::size_t>(burst.bus)];
  const auto first = static_cast<std::uint32_t>(signals_.bus(burst.bus));
  stream.add(burst.address_ps, first + VcdSignals::kBusOwner, signals_.word(burst.master));
  stream.add(burst.address_ps, first + VcdSignals::kPhase, signals_.word("address"));
  stream.add(burst.address_ps, first + VcdSignals::kDirection, words_.accesses[burst.write ? 1 : 0]);
  stream.add(burst.address_ps, first + VcdSignals::kTarget, signals_.word(burst.target));
  const bool is_local = burst.bus == BusBurst::Bus::kLocal;
  const std::uint64_t address = is_local ? memory::address_in_bank(burst.address) : burst.address;
  stream.add(burst.address_ps, first + VcdSignals::kBusAddress, static_cast<std::uint32_t>(address));
  stream.add(burst.data_ps, first + VcdSignals::kPhase, signals_.word("data"));
  for (std::uint32_t signal = first; signal <= first + VcdSignals::kBusAddress; ++signal)
    stream.add(burst.end_ps, signal, signals_.all()[signal].idle);
}

void VcdWriter::level(const platform::QueueLevel& level) {
  const std::size_t signal = signals_.queue(level.queue);
  queues_[signal - signals_.queue("left_capture")].add(level.time_ps, static_cast<std::uint32_t>(signal),
                                                       static_cast<std::uint32_t>(level.words));
}

void VcdWriter::complete(const TimeSpan& window) {
  end_cycles();
  std::vector<ChangeStream*> streams = {&core_};
  for (ChangeStream& stream : buses_) streams.push_back(&stream);
  for (ChangeStream& stream : queues_) streams.push_back(&stream);
  const VcdSpan span = write_waveform(streams, window);
  if (layout_) layout_->write(gtkwave_layout(path_.filename().string(), signals_, span));
  file_.complete();
  if (layout_) layout_->complete();
}

void VcdWriter::commit() {
  file_.commit();
  if (layout_) layout_->commit();
}

VcdSpan VcdWriter::write_waveform(const std::vector<ChangeStream*>& streams, const TimeSpan& window) {
  if (!is_fst(path_)) return write_vcd(file_.aside(), signals_, streams, window);
  files::AsideFile text(files::linked_file(path_), path_.string());
  const VcdSpan span = write_vcd(text, signals_, streams, window);
  text.complete();
  const process::CommandEnd end =
      process::run_command({"vcd2fst", text.path().string(), file_.aside().path().string()});
  if (end.status != 0 || fs::file_size(file_.aside().path()) == 0)
    throw std::runtime_error(
        fmt::format("{}: vcd2fst ends with status {}: {}", path_.string(), end.status, end.errors));
  return span;
}

}  // namespace stereotlm::trace
