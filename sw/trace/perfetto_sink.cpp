#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <list>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sw/trace/trace_board.h"
#include "sw/trace/trace_sink.h"

namespace stereotlm::trace {
namespace {

// A message of Protocol Buffers in its wire format: fields, each with its number, in the order of the calls.
class ProtoMessage {
 public:
  ProtoMessage& integer(std::uint32_t field, std::uint64_t value) {
    return varint(field << 3U).varint(value);
  }
  ProtoMessage& fixed(std::uint32_t field, std::uint64_t value) {
    varint(field << 3U | 1U);
    for (unsigned byte = 0; byte < 8; ++byte) bytes_ += static_cast<char>(value >> (8U * byte));
    return *this;
  }
  // A text or another message.
  ProtoMessage& text(std::uint32_t field, std::string_view text) {
    varint(field << 3U | 2U).varint(text.size()).bytes_ += text;
    return *this;
  }
  operator std::string_view() const { return bytes_; }
  void clear() { bytes_.clear(); }

 private:
  ProtoMessage& varint(std::uint64_t value) {
    constexpr std::uint64_t kMore = 0x80;
    for (; value >= kMore; value >>= 7U) bytes_ += static_cast<char>(value | kMore);
    bytes_ += static_cast<char>(value);
    return *this;
  }

  std::string bytes_;
};

// Numbers of fields and values in google/perfetto, protos/perfetto/trace.
constexpr std::uint32_t kPacket = 1;  // in Trace
namespace packet {
constexpr std::uint32_t kClockSnapshot = 6, kTimestamp = 8, kSequence = 10, kTrackEvent = 11,
                        kInternedData = 12, kSequenceFlags = 13, kDefaults = 59, kTrackDescriptor = 60,
                        kForTesting = 900;
constexpr std::uint32_t kDefaultClock = 58;  // in TracePacketDefaults
constexpr std::uint64_t kStateCleared = 1, kNeedsState = 2;
}  // namespace packet
namespace descriptor {
constexpr std::uint32_t kUuid = 1, kName = 2, kProcess = 3, kParent = 5, kCounter = 8, kChildOrder = 11,
                        kRank = 12;
constexpr std::uint64_t kByRank = 3;
constexpr std::uint32_t kPid = 1, kProcessName = 6;  // in ProcessDescriptor
constexpr std::uint32_t kUnitName = 6;               // in CounterDescriptor
}  // namespace descriptor
namespace event {
constexpr std::uint32_t kArgument = 4, kType = 9, kName = 10, kTrack = 11, kCounter = 30, kDoubleCounter = 44,
                        kFlow = 47;
constexpr std::uint64_t kBegin = 1, kEnd = 2, kInstant = 3, kCount = 4;
constexpr std::uint32_t kArgumentName = 1, kNumber = 3;  // in DebugAnnotation
}  // namespace event
namespace interned {
constexpr std::uint32_t kEventNames = 2, kArgumentNames = 3;
constexpr std::uint32_t kNumber = 1, kName = 2;  // in EventName and DebugAnnotationName
}  // namespace interned
namespace clocks {
constexpr std::uint32_t kClock = 1, kPrimary = 2;
constexpr std::uint32_t kId = 1, kTimestamp = 2, kIsIncremental = 3;  // in Clock
constexpr std::uint64_t kBootTime = 6, kOfSequence = 64;
}  // namespace clocks

constexpr std::uint64_t kProcessUuid = 1;

ProtoMessage described(std::uint64_t uuid, std::uint64_t parent, std::size_t rank, const std::string& name) {
  return ProtoMessage()
      .integer(descriptor::kUuid, uuid)
      .text(descriptor::kName, name)
      .integer(descriptor::kParent, parent)
      .integer(descriptor::kRank, rank);
}

// The first packet of every file, by which the file is known: a text that viewers ignore.
std::string perfetto_mark() {
  const ProtoMessage event = ProtoMessage().text(1, "trace of stereotlm");  // TestEvent.str
  const ProtoMessage packet = ProtoMessage().text(packet::kForTesting, event);
  return std::string(ProtoMessage().text(kPacket, packet));
}

// The groups of tracks, from top to bottom.
enum class TrackGroup : std::uint8_t { kCore, kPorts, kBanks, kQueues, kBuses, kCapture, kSoftware };
constexpr std::array<const char*, 7> kTrackGroupNames = {"core",  "ports",   "banks",   "queues",
                                                         "buses", "capture", "software"};

// A trace of Perfetto: a process, and below it groups of tracks. A group is written with its first track. The
// tracks of lanes are below one of their port group: "left_lut.0" is below "left_lut".
class PerfettoFile {
 public:
  PerfettoFile(files::OutputFile& file, const std::string& process) : file_(file), last_uuid_(kProcessUuid) {
    file_.write(perfetto_mark());
    const ProtoMessage of_process =
        ProtoMessage().integer(descriptor::kPid, 1).text(descriptor::kProcessName, process);
    const ProtoMessage track =
        ProtoMessage().integer(descriptor::kUuid, kProcessUuid).text(descriptor::kProcess, of_process);
    write(ProtoMessage().text(packet::kTrackDescriptor, track));
  }

 private:
  friend class PerfettoTrack;

  // Describes a track, and its group if that is new. Returns the uuid of the track.
  std::uint64_t add(TrackGroup group, std::size_t rank, const std::string& name, const std::string& unit) {
    const auto below = [this](std::uint64_t parent, std::uint64_t& uuid, std::size_t its_rank,
                              const std::string& its_name) {
      if (uuid != 0) return uuid;
      ProtoMessage message = described(uuid = ++last_uuid_, parent, its_rank, its_name);
      message.integer(descriptor::kChildOrder, descriptor::kByRank);
      write(ProtoMessage().text(packet::kTrackDescriptor, message));
      return uuid;
    };
    const auto place = static_cast<std::size_t>(group);
    std::uint64_t parent = below(kProcessUuid, groups_[place], place, kTrackGroupNames[place]);
    const std::string ports = name.substr(0, name.find('.'));
    if (group == TrackGroup::kPorts && ports != name)
      parent = below(parent, port_groups_[ports], rank, ports);
    ProtoMessage track = described(++last_uuid_, parent, rank, name);
    if (!unit.empty()) track.text(descriptor::kCounter, ProtoMessage().text(descriptor::kUnitName, unit));
    write(ProtoMessage().text(packet::kTrackDescriptor, track));
    return last_uuid_;
  }
  void write(std::string_view packet) {
    packet_.clear();
    file_.write(packet_.text(kPacket, packet));
  }

  files::OutputFile& file_;
  ProtoMessage packet_;
  std::uint64_t last_uuid_;
  std::array<std::uint64_t, kTrackGroupNames.size()> groups_{};  // uuid; 0: not written
  std::map<std::string, std::uint64_t> port_groups_;             // uuid, by name
};

// A track, which is written when its first event comes. Each track is a packet sequence of its own, with its
// own table of names, and with times that are differences to the packet before. The times of a track
// therefore never decrease; those of different tracks are independent.
class PerfettoTrack {
 public:
  // An argument of a slice, which is left out if it has no value.
  struct Argument {
    const char* name;
    std::optional<std::uint64_t> value;
  };
  using Arguments = std::initializer_list<Argument>;
  using Flows = std::vector<std::uint64_t>;

  // `rank` orders the tracks of a group. `unit`: of a counter; empty for a track of slices.
  PerfettoTrack(PerfettoFile& file, TrackGroup group, std::size_t rank, std::string name,
                std::string unit = {})
      : file_(file), group_(group), rank_(rank), name_(std::move(name)), unit_(std::move(unit)) {}

  // Times are in ns. An arrow leads from each slice to the next one with the same flow.
  void begin(std::uint64_t time_ns, std::string_view name, Arguments arguments, const Flows& flows = {}) {
    write_event(time_ns, event::kBegin, name, arguments, flows);
  }
  void end(std::uint64_t time_ns) { write_event(time_ns, event::kEnd); }
  void slice(std::uint64_t begin_ns, std::uint64_t end_ns, std::string_view name, Arguments arguments,
             const Flows& flows = {}) {
    begin(begin_ns, name, arguments, flows);
    end(end_ns);
  }
  void instant(std::uint64_t time_ns, std::string_view name, Arguments arguments) {
    write_event(time_ns, event::kInstant, name, arguments);
  }
  // Writes the value if it differs from the last one.
  void count(std::uint64_t time_ns, double value) {
    if (value == last_value_) return;
    last_value_ = value;
    const auto whole = static_cast<std::uint64_t>(value);
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    static_cast<double>(whole) == value ? event_.integer(event::kCounter, whole)
                                        : event_.fixed(event::kDoubleCounter, bits);
    write_event(time_ns, event::kCount);
  }

  std::uint64_t last_ns() const { return last_ns_; }
  bool is_written() const { return uuid_ != 0; }

 private:
  // A table that has become larger is begun anew, so that memory does not grow with the run.
  static constexpr std::size_t kMostNames = 4096;

  // Begins with empty tables of names. The uuid of the track serves as the number of the sequence. Both
  // clocks show 0: the first time of a sequence counts from power-up, the next ones from the packet before.
  void start_sequence() {
    names_ = {};
    last_ns_ = 0;
    const auto clock = [](std::uint64_t id) {
      return ProtoMessage().integer(clocks::kId, id).integer(clocks::kTimestamp, 0);
    };
    const ProtoMessage snapshot =
        ProtoMessage()
            .text(clocks::kClock, clock(clocks::kBootTime))
            .text(clocks::kClock, clock(clocks::kOfSequence).integer(clocks::kIsIncremental, 1))
            .integer(clocks::kPrimary, clocks::kBootTime);
    const ProtoMessage defaults =
        ProtoMessage()
            .integer(packet::kDefaultClock, clocks::kOfSequence)
            .text(packet::kTrackEvent, ProtoMessage().integer(event::kTrack, uuid_));
    file_.write(ProtoMessage()
                    .integer(packet::kSequence, uuid_)
                    .integer(packet::kSequenceFlags, packet::kStateCleared)
                    .text(packet::kClockSnapshot, snapshot)
                    .text(packet::kDefaults, defaults));
  }
  // The number of a name in its table (a field of the interned data). A new name goes into the packet.
  std::uint64_t number_of(std::uint32_t table, std::string_view name) {
    auto& names = names_[table - interned::kEventNames];
    const auto [entry, is_new] = names.try_emplace(std::string(name), names.size() + 1);
    if (is_new) {
      interned_.text(table,
                     ProtoMessage().integer(interned::kNumber, entry->second).text(interned::kName, name));
    }
    return entry->second;
  }
  // Writes the event with these fields too, and clears it.
  void write_event(std::uint64_t time_ns, std::uint64_t type, std::string_view name = {},
                   Arguments arguments = {}, const Flows& flows = {}) {
    const bool is_new = !is_written();
    if (is_new) uuid_ = file_.add(group_, rank_, name_, unit_);
    if (is_new || (!name.empty() && names_[0].size() >= kMostNames)) start_sequence();
    if (!name.empty()) event_.integer(event::kName, number_of(interned::kEventNames, name));
    for (const Argument& argument : arguments) {
      if (!argument.value) continue;
      event_.text(event::kArgument,
                  ProtoMessage()
                      .integer(event::kArgumentName, number_of(interned::kArgumentNames, argument.name))
                      .integer(event::kNumber, *argument.value));
    }
    for (const std::uint64_t flow : flows) event_.fixed(event::kFlow, flow);
    event_.integer(event::kType, type);
    packet_.integer(packet::kTimestamp, time_ns - last_ns_)
        .integer(packet::kSequence, uuid_)
        .integer(packet::kSequenceFlags, packet::kNeedsState);
    const std::string_view names = interned_;
    if (!names.empty()) packet_.text(packet::kInternedData, names);
    file_.write(packet_.text(packet::kTrackEvent, event_));
    last_ns_ = time_ns;
    for (ProtoMessage* const message : {&interned_, &event_, &packet_}) message->clear();
  }

  PerfettoFile& file_;
  TrackGroup group_;
  std::size_t rank_;
  std::string name_;
  std::string unit_;
  std::uint64_t uuid_ = 0;  // 0: not written
  std::uint64_t last_ns_ = 0;
  double last_value_ = -1;  // of a counter, whose values are not negative
  std::array<std::unordered_map<std::string, std::uint64_t>, 2> names_;  // of events, of arguments
  // Parts of the packet that is made.
  ProtoMessage interned_;
  ProtoMessage event_;
  ProtoMessage packet_;
};

// Tracks of one name, which Perfetto shows as one. Slices that overlap without being nested need several. The
// slices come in the order of their ends.
class OverlappingTracks {
 public:
  OverlappingTracks(PerfettoFile& file, TrackGroup group, std::size_t rank, const std::string& name)
      : first_(file, group, rank, name), tracks_({first_}) {}

  // A track whose last slice has ended by then.
  PerfettoTrack& free_at(std::uint64_t begin_ns) {
    for (PerfettoTrack& track : tracks_) {
      if (track.last_ns() <= begin_ns) return track;
    }
    return tracks_.emplace_back(first_);
  }

 private:
  PerfettoTrack first_;  // never written
  std::list<PerfettoTrack> tracks_;
};

using fpga::CoreCycle;
using fpga::Intent;
using fpga::PortCycle;
using platform::BusBurst;
using platform::EventKind;
using platform::TimelineEvent;
using platform::TraceRun;
using Flows = PerfettoTrack::Flows;

constexpr std::uint64_t kPsPerNs = 1000;
// Arrows of waits inside a window, and of data, have numbers of their own. Those of rows are small.
constexpr std::uint64_t kFirstWaitFlow = std::uint64_t{1} << 62U;
constexpr std::uint64_t kDataFlow = std::uint64_t{1} << 63U;
constexpr std::size_t kFirstQueueRank = 3;  // behind those of the core

// The tracks of a bank: its only one, or that of its reads; and that of its writes. [2 * bank + is_second]
std::size_t bank_track(const TraceBoard& board, std::size_t bank, std::size_t requester) {
  return 2 * bank + (board.requesters.writes(requester) && board.has_separate_ports(bank) ? 1 : 0);
}

// The frames of the core: a slice for each frame, each strip, and each run of a strip. The slices of a port
// in a strip stand one behind the other, first the accesses, then the waits, each as long as its cycles.
class Rows {
 public:
  Rows(const TraceBoard& board, PerfettoFile& file)
      : board_(board),
        frames_(file, TrackGroup::kCore, 0, "frames"),
        strips_(file, TrackGroup::kCore, 1, "rows") {
    for (std::size_t requester = 0; requester < board.requesters.size(); ++requester) {
      const std::string& name = board.requester_names[requester];
      ports_.push_back({{file, TrackGroup::kPorts, 3 * requester, name}});
      port_waits_.emplace_back(file, TrackGroup::kPorts, 3 * requester + 2, name + " waits in each row",
                               "cycles");
    }
    for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
      const std::string& name = board.bank_texts[bank];
      const bool is_separate = board.has_separate_ports(bank);
      banks_.push_back({{file, TrackGroup::kBanks, 5 * bank, is_separate ? name + " reads" : name}});
      banks_.push_back({{file, TrackGroup::kBanks, 5 * bank + 1, name + " writes"}});
      bank_use_.emplace_back(file, TrackGroup::kBanks, 5 * bank + 4, name + " use", "%");
    }
  }

  void frame(const platform::FrameRuns& frame) {
    frames_.slice(ns(frame.first_cycle), ns(frame.end_cycle), fmt::format("frame {}", frame.frame), {});
    first_run_ = frame.runs.data();
    const TraceRun* run = first_run_;
    const TraceRun* const end = run + frame.runs.size();
    std::uint64_t first_cycle = frame.first_cycle;
    for (std::size_t strip = 0; strip < frame.strip_ends.size(); ++strip) {
      const TraceRun* const next =
          std::find_if(run, end, [strip](const TraceRun& later) { return later.strip != strip; });
      const std::uint64_t end_cycle = frame.strip_ends[strip];
      strips_.slice(ns(first_cycle), ns(end_cycle), name_of(strip), {{"cycles", end_cycle - first_cycle}});
      write_runs(run, next, first_cycle);
      write_counters(run, next, first_cycle, end_cycle);
      run = next;
      first_cycle = end_cycle;
    }
    first_flow_ += frame.runs.size();
    for (auto* const tracks : {&port_waits_, &bank_use_}) {
      for (PerfettoTrack& track : *tracks) {
        if (track.is_written()) track.count(ns(frame.end_cycle), 0);
      }
    }
  }

 private:
  struct Row {
    PerfettoTrack track;
    std::uint64_t free_cycle = 0;
  };

  std::uint64_t ns(std::uint64_t cycle) const { return board_.ps(cycle) / kPsPerNs; }
  std::uint64_t flow_of(const TraceRun& run) const {
    return first_flow_ + static_cast<std::uint64_t>(&run - first_run_);
  }

  std::string name_of(std::size_t strip) const {
    if (strip == 0) return "fill";
    const int first = (static_cast<int>(strip) - 1) * board_.geometry.rows;
    const int last = std::min(first + board_.geometry.rows, board_.geometry.height) - 1;
    return first == last ? fmt::format("row {}", first) : fmt::format("rows {}..{}", first, last);
  }

  // The accesses of all ports come before the waits. A wait may then have an arrow from the accesses of the
  // winner: of two slices that begin at one time, the arrow leads from the first in the file.
  void write_runs(const TraceRun* begin, const TraceRun* end, std::uint64_t first_cycle) {
    for (std::vector<Row>* const rows : {&ports_, &banks_}) {
      for (Row& row : *rows) row.free_cycle = std::max(row.free_cycle, first_cycle);
    }
    for (const TraceRun* run = begin; run != end; ++run) {
      if (run->by) continue;
      Flows flows;
      for (const TraceRun* wait = begin; wait != end; ++wait) {
        if (wait->by == run->requester && wait->bank == run->bank) flows.push_back(flow_of(*wait));
      }
      write_run(ports_[run->requester], *run,
                fmt::format("{} {} x{}", board_.requesters.writes(run->requester) ? "writes" : "reads",
                            board_.bank_texts[run->bank], run->count),
                flows);
      write_run(banks_[bank_track(board_, run->bank, run->requester)], *run,
                fmt::format("{} x{}", board_.requester_names[run->requester], run->count), {});
    }
    for (const TraceRun* run = begin; run != end; ++run) {
      if (!run->by) continue;
      write_run(ports_[run->requester], *run,
                board_.wait_text(run->requester, run->count, *run->by, run->bank),
                board_.requesters.is_requester(*run->by) ? Flows{flow_of(*run)} : Flows{});
    }
  }

  void write_run(Row& row, const TraceRun& run, std::string_view name, const Flows& flows) {
    const std::uint64_t end_cycle = row.free_cycle + run.count;
    row.track.slice(ns(row.free_cycle), ns(end_cycle), name, {}, flows);
    row.free_cycle = end_cycle;
  }

  void write_counters(const TraceRun* begin, const TraceRun* end, std::uint64_t first_cycle,
                      std::uint64_t end_cycle) {
    std::vector<std::uint64_t> waits(board_.requesters.size());
    std::vector<std::uint64_t> uses(board_.banks.size());
    for (const TraceRun* run = begin; run != end; ++run)
      (run->by ? waits[run->requester] : uses[run->bank]) += run->count;
    const auto count = [time_ns = ns(first_cycle)](PerfettoTrack& track, double value) {
      if (value != 0 || track.is_written()) track.count(time_ns, value);
    };
    for (std::size_t requester = 0; requester < waits.size(); ++requester)
      count(port_waits_[requester], static_cast<double>(waits[requester]));
    const auto cycles = static_cast<double>(std::max<std::uint64_t>(end_cycle - first_cycle, 1));
    for (std::size_t bank = 0; bank < uses.size(); ++bank)
      count(bank_use_[bank], 100 * static_cast<double>(uses[bank]) / cycles);
  }

  const TraceBoard& board_;
  PerfettoTrack frames_;
  PerfettoTrack strips_;
  std::vector<Row> ports_;                 // [requester]
  std::vector<PerfettoTrack> port_waits_;  // [requester]
  std::vector<Row> banks_;                 // [bank_track()]
  std::vector<PerfettoTrack> bank_use_;    // [bank]
  const TraceRun* first_run_ = nullptr;    // of the frame
  std::uint64_t first_flow_ = 1;           // of that run; the next ones follow
};

// The cycles of a window: a slice for each access, and one for consecutive cycles in which a port is in the
// same state (if it waits: for the same port), a bank has the same owner, or the matcher works.
class Cycles {
 public:
  Cycles(const TraceBoard& board, PerfettoFile& file)
      : board_(board),
        matcher_(file, TrackGroup::kCore, 2, "matcher"),
        queues_{PerfettoTrack(file, TrackGroup::kQueues, 0, "left lane", "slots"),
                PerfettoTrack(file, TrackGroup::kQueues, 1, "right lane", "slots"),
                PerfettoTrack(file, TrackGroup::kQueues, 2, "results", "words")},
        port_runs_(board.ports().size()),
        bank_runs_(2 * board.banks.size()),
        flows_(board.requesters.size()) {
    for (std::size_t requester = 0; requester < board.requesters.size(); ++requester)
      ports_.emplace_back(file, TrackGroup::kPorts, 3 * requester + 1,
                          board.requester_names[requester] + " cycles");
    for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
      const std::string& name = board.bank_texts[bank];
      const std::string first = board.has_separate_ports(bank) ? " read cycles" : " cycles";
      banks_.emplace_back(file, TrackGroup::kBanks, 5 * bank + 2, name + first);
      banks_.emplace_back(file, TrackGroup::kBanks, 5 * bank + 3, name + " write cycles");
      access_.push_back({"reads " + name, "writes " + name});
    }
  }

  void cycle(const CoreCycle& cycle) {
    if (next_cycle_ && *next_cycle_ != cycle.cycle) end();
    next_cycle_ = cycle.cycle + 1;
    std::vector<Run> owners(bank_runs_.size());
    for (std::size_t port = 0; port < port_runs_.size(); ++port) {
      show(port_runs_[port], run_of(cycle, port), cycle.cycle);
      set_owner(cycle, port, owners);
    }
    for (std::size_t port = 0; port < port_runs_.size(); ++port) {
      if (cycle.ports[port].granted) write_access(cycle, port);
    }
    show_rest(cycle, owners);
  }

  void end() {
    if (!next_cycle_) return;
    CoreCycle idle;
    idle.cycle = *next_cycle_;
    idle.lane_slots.resize(2 * board_.ports().lanes());
    for (Run& run : port_runs_) show(run, {}, idle.cycle);
    show_rest(idle, std::vector<Run>(bank_runs_.size()));
    next_cycle_.reset();
  }

 private:
  enum class Arrow : std::uint8_t { kToPixel, kToResult };
  // The slices of what a port does beside its accesses. [fpga::Intent]
  static constexpr std::array<const char*, 5> kIntents = {"waits", "passes", nullptr, "blocked", "starved"};
  struct Run {
    const char* name = nullptr;  // of its slice; null: there is none
    PerfettoTrack* track = nullptr;
    std::size_t requester = 0;  // of a wait, like `bank` and `by`
    std::size_t bank = 0;
    std::size_t by = 0;
    std::uint64_t first_cycle = 0;
    std::uint64_t flow = 0;  // of a wait: the arrow from the access of the winner

    auto key() const { return std::tie(name, track, bank, by); }
    bool waits() const { return name == kIntents[0]; }
  };

  std::uint64_t ns(std::uint64_t cycle) const { return board_.ps(cycle) / kPsPerNs; }

  Run run_of(const CoreCycle& cycle, std::size_t port) {
    const PortCycle& now = cycle.ports[port];
    if (now.granted) return {};
    const std::size_t requester = board_.requesters.of_port(port, cycle.host_traffic);
    Run run{kIntents[static_cast<std::size_t>(now.intent)], &ports_[requester], requester};
    if (!run.waits()) return run;
    run.bank = now.bank;
    run.by = now.by;
    return run;
  }

  // Ends the run if `now` is another one, which then begins in this cycle.
  void show(Run& run, const Run& now, std::uint64_t cycle) {
    if (run.key() == now.key()) return;
    if (run.name != nullptr) {
      const std::uint64_t cycles = cycle - run.first_cycle;
      const std::string name =
          run.waits() ? board_.wait_text(run.requester, cycles, run.by, run.bank) : run.name;
      run.track->slice(ns(run.first_cycle), ns(cycle), name, {{"cycles", cycles}},
                       run.flow != 0 ? Flows{run.flow} : Flows{});
    }
    run = now;
    run.first_cycle = cycle;
    if (!run.waits() || !board_.requesters.is_requester(run.by)) return;
    run.flow = kFirstWaitFlow + waits_++;
    flows_[run.by].push_back(run.flow);
  }

  void set_owner(const CoreCycle& cycle, std::size_t port, std::vector<Run>& owners) {
    const PortCycle& now = cycle.ports[port];
    if (now.intent != Intent::kRequest) return;
    const std::size_t requester = board_.requesters.of_port(port, cycle.host_traffic);
    const std::size_t track = bank_track(board_, now.bank, requester);
    if (!now.granted && board_.requesters.is_requester(now.by)) return;
    owners[track].name = board_.requester_names[now.granted ? requester : now.by].c_str();
    owners[track].track = &banks_[track];
  }

  void show_rest(const CoreCycle& cycle, const std::vector<Run>& owners) {
    for (std::size_t track = 0; track < owners.size(); ++track)
      show(bank_runs_[track], owners[track], cycle.cycle);
    show(matcher_run_, cycle.works ? Run{"works", &matcher_} : Run{}, cycle.cycle);
    const auto middle = cycle.lane_slots.begin() + static_cast<std::ptrdiff_t>(board_.ports().lanes());
    const std::array<std::uint32_t, 3> levels = {std::accumulate(cycle.lane_slots.begin(), middle, 0U),
                                                 std::accumulate(middle, cycle.lane_slots.end(), 0U),
                                                 cycle.result_words};
    for (std::size_t queue = 0; queue < levels.size(); ++queue)
      queues_[queue].count(ns(cycle.cycle), levels[queue]);
  }

  void write_access(const CoreCycle& cycle, std::size_t port) {
    const PortCycle& now = cycle.ports[port];
    const std::size_t requester = board_.requesters.of_port(port, cycle.host_traffic);
    add_data_flows(cycle, port);
    const std::string& name = access_[now.bank][board_.requesters.writes(requester) ? 1 : 0];
    std::optional<std::uint64_t> item;
    std::optional<std::uint64_t> row;
    std::optional<std::uint64_t> column;
    if (port != board_.ports().host()) {
      const SlotPlace place = board_.place_of(port, now.item);
      item = now.item;
      row = static_cast<std::uint64_t>(place.row);
      column = static_cast<std::uint64_t>(place.column);
    }
    ports_[requester].slice(ns(cycle.cycle), ns(cycle.cycle + 1), name,
                            {{"address", now.address},
                             {port == board_.ports().result() ? "word" : "slot", item},
                             {"row", row},
                             {"column", column}},
                            flows_[requester]);
    flows_[requester].clear();
  }

  // The arrows of a pixel: from its table entry to itself, and from the left pixel to the word that holds its
  // disparity. Each has its own number: a pixel that is passed ends the first and begins no second one.
  void add_data_flows(const CoreCycle& cycle, std::size_t port) {
    if (port == board_.ports().host() || !cycle.frame) return;
    const auto add = [&](Arrow arrow, fpga::Side side, std::uint64_t slot) {
      const std::uint64_t pixel = (*cycle.frame * board_.geometry.slots + slot) * 2 + fpga::index_of(side);
      flows_[port].push_back(kDataFlow | (pixel * 2 + static_cast<std::uint64_t>(arrow)));
    };
    const std::uint64_t item = cycle.ports[port].item;
    if (port == board_.ports().result()) {
      const auto slots = board_.slots_of_word(item);
      if (!slots) return;
      for (const std::uint64_t slot : *slots) add(Arrow::kToResult, fpga::Side::kLeft, slot);
      return;
    }
    const fpga::PortGroup& group = board_.ports().group(port);
    const bool is_pixel = group.stage == fpga::PortStage::kPixelReader;
    const std::uint64_t slot = board_.slot_of_item(port, item);
    add(Arrow::kToPixel, group.side, slot);
    if (is_pixel && group.side == fpga::Side::kLeft) add(Arrow::kToResult, group.side, slot);
    if (board_.core.joint_tables && !is_pixel) add(Arrow::kToPixel, fpga::Side::kRight, slot);
  }

  const TraceBoard& board_;
  std::vector<PerfettoTrack> ports_;  // [requester]
  std::vector<PerfettoTrack> banks_;  // [bank_track()]
  PerfettoTrack matcher_;
  std::array<PerfettoTrack, 3> queues_;             // left lane, right lane, results
  std::vector<std::array<std::string, 2>> access_;  // [bank][write]: name of a slice
  std::vector<Run> port_runs_;                      // [port]
  std::vector<Run> bank_runs_;                      // [bank_track()]
  Run matcher_run_;
  std::optional<std::uint64_t> next_cycle_;  // the one behind the last cycle
  std::uint64_t waits_ = 0;
  std::vector<Flows> flows_;  // [requester]: of its access
};

// The computer around the core: bursts of both buses, levels of queues, and the events of the time line.
class Computer {
 public:
  explicit Computer(PerfettoFile& file)
      : file_(file),
        buses_{Bus{{file, TrackGroup::kBuses, 0, "pci"}, {file, TrackGroup::kBuses, 1, "pci waits"}},
               Bus{{file, TrackGroup::kBuses, 2, "local bus"},
                   {file, TrackGroup::kBuses, 3, "local bus waits"}}} {}

  void burst(const BusBurst& burst) {
    Bus& bus = buses_[static_cast<std::size_t>(burst.bus)];
    const std::uint64_t request = burst.request_ps / kPsPerNs;
    const std::uint64_t address = burst.address_ps / kPsPerNs;
    const std::uint64_t data = burst.data_ps / kPsPerNs;
    const std::uint64_t end = burst.end_ps / kPsPerNs;
    if (request < address)
      bus.waits.free_at(request).slice(request, address, fmt::format("{} waits", burst.master), {});
    PerfettoTrack& track = bus.bursts.free_at(address);
    track.begin(address,
                fmt::format("{} {} {}", burst.master, burst.write ? "writes" : "reads", target_text(burst)),
                {{"address", burst.address}, {"words", burst.words}});
    track.slice(address, data, "address", {});
    if (data < end) track.slice(data, end, "data", {});
    track.end(end);
  }

  void level(const platform::QueueLevel& level) {
    const std::size_t rank = kFirstQueueRank + queues_.size();
    queues_.try_emplace(level.queue, file_, TrackGroup::kQueues, rank, level.queue, "words")
        .first->second.count(level.time_ps / kPsPerNs, static_cast<double>(level.words));
  }

  void event(const TimelineEvent& event) {
    const Shown& shown = kShown[static_cast<std::size_t>(event.kind)];
    const std::string name = fmt::format(fmt::runtime(shown.track), event.what);
    const std::string slice = fmt::format(fmt::runtime(shown.slice), event.what, event.why);
    const std::size_t rank = 3 + static_cast<std::size_t>(event.kind);
    const std::uint64_t begin = event.begin_ps / kPsPerNs;
    PerfettoTrack& track =
        events_.try_emplace(name, file_, shown.group, rank, name).first->second.free_at(begin);
    if (event.kind == EventKind::kDrop)
      return track.instant(begin, slice, {{"camera frame", event.camera_frame}});
    const auto given = [](std::uint64_t number) {
      return number != 0 ? std::optional(number) : std::nullopt;
    };
    track.slice(begin, event.end_ps / kPsPerNs, slice,
                {{"frame", event.frame},
                 {"camera frame", event.camera_frame},
                 {"words", given(event.words)},
                 {"dropped pixels", given(event.dropped_pixels)}});
  }

 private:
  struct Bus {
    OverlappingTracks bursts;
    OverlappingTracks waits;
  };
  // The track and the slice of an event, by its class and, of a drop or a wait, its reason.
  struct Shown {
    TrackGroup group;
    const char* track;
    const char* slice;
  };
  // [EventKind]
  static constexpr std::array<Shown, platform::kEventKindNames.size()> kShown = {
      {{TrackGroup::kCapture, "{}", "capture"},
       {TrackGroup::kCapture, "{}", "drop: {1}"},
       {TrackGroup::kSoftware, "uploads", "{}"},
       {TrackGroup::kSoftware, "read-backs", "{}"},
       {TrackGroup::kCore, "core", "{}"},
       {TrackGroup::kSoftware, "interrupt {}", "interrupt {}"},
       {TrackGroup::kSoftware, "wait {}", "{} waits: {}"}}};

  PerfettoFile& file_;
  std::array<Bus, 2> buses_;
  std::map<std::string, PerfettoTrack> queues_;
  std::map<std::string, OverlappingTracks> events_;
};

class PerfettoSink : public TraceSink {
 public:
  PerfettoSink(const std::filesystem::path& path, const platform::BoardConfig& board)
      : board_(board),
        file_(files_.emplace_back(path,
                                  files::marked_kind("Perfetto trace of stereotlm", {{0, perfetto_mark()}})),
              "stereotlm " + board.name) {}

  void cycle(const CoreCycle& cycle) override { cycles_.cycle(cycle); }
  void burst(const BusBurst& burst) override { computer_.burst(burst); }
  void level(const platform::QueueLevel& level) override { computer_.level(level); }
  void frame(const platform::FrameRuns& frame) override { rows_.frame(frame); }
  void event(const TimelineEvent& event) override { computer_.event(event); }
  void end(const TimeSpan& /*window*/) override { cycles_.end(); }

 private:
  TraceBoard board_;
  PerfettoFile file_;
  Rows rows_{board_, file_};
  Cycles cycles_{board_, file_};
  Computer computer_{file_};
};

}  // namespace

std::unique_ptr<TraceSink> perfetto_sink(const std::filesystem::path& path,
                                         const platform::BoardConfig& board) {
  return std::make_unique<PerfettoSink>(path, board);
}

}  // namespace stereotlm::trace
