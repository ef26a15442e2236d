#include "sw/trace/perfetto_track.h"

namespace stereotlm::trace {
namespace {

// Numbers of fields and values in google/perfetto, protos/perfetto/trace.
namespace trace_file {
constexpr std::uint32_t kPacket = 1;
}
namespace trace_packet {
constexpr std::uint32_t kClockSnapshot = 6;
constexpr std::uint32_t kTimestamp = 8;
constexpr std::uint32_t kSequence = 10;
constexpr std::uint32_t kTrackEvent = 11;
constexpr std::uint32_t kInternedData = 12;
constexpr std::uint32_t kSequenceFlags = 13;
constexpr std::uint32_t kDefaultClock = 58;  // in TracePacketDefaults
constexpr std::uint32_t kDefaults = 59;
constexpr std::uint32_t kTrackDescriptor = 60;
constexpr std::uint32_t kForTesting = 900;
constexpr std::uint32_t kText = 1;  // in TestEvent
constexpr std::uint64_t kStateCleared = 1;
constexpr std::uint64_t kNeedsState = 2;
}  // namespace trace_packet
namespace track_descriptor {
constexpr std::uint32_t kUuid = 1;
constexpr std::uint32_t kName = 2;
constexpr std::uint32_t kProcess = 3;
constexpr std::uint32_t kParent = 5;
constexpr std::uint32_t kCounter = 8;
constexpr std::uint32_t kChildOrder = 11;
constexpr std::uint32_t kRank = 12;
constexpr std::uint64_t kByRank = 3;
constexpr std::uint32_t kPid = 1;  // in ProcessDescriptor
constexpr std::uint32_t kProcessName = 6;
constexpr std::uint32_t kUnitName = 6;  // in CounterDescriptor
}  // namespace track_descriptor
namespace track_event {
constexpr std::uint32_t kArgument = 4;
constexpr std::uint32_t kType = 9;
constexpr std::uint32_t kName = 10;
constexpr std::uint32_t kTrack = 11;
constexpr std::uint32_t kCounter = 30;
constexpr std::uint32_t kDoubleCounter = 44;
constexpr std::uint32_t kFlow = 47;
constexpr std::uint64_t kBegin = 1;
constexpr std::uint64_t kEnd = 2;
constexpr std::uint64_t kInstant = 3;
constexpr std::uint64_t kCount = 4;
}  // namespace track_event
namespace argument {
constexpr std::uint32_t kName = 1;
constexpr std::uint32_t kNumber = 3;
}  // namespace argument
namespace interned {
constexpr std::uint32_t kEventNames = 2;
constexpr std::uint32_t kArgumentNames = 3;
constexpr std::uint32_t kNumber = 1;
constexpr std::uint32_t kName = 2;
}  // namespace interned
namespace clock_snapshot {
constexpr std::uint32_t kClock = 1;
constexpr std::uint32_t kPrimary = 2;
constexpr std::uint32_t kId = 1;
constexpr std::uint32_t kTimestamp = 2;
constexpr std::uint32_t kIsIncremental = 3;
constexpr std::uint64_t kBootTime = 6;
constexpr std::uint64_t kOfSequence = 64;
}  // namespace clock_snapshot

ProtoMessage clock(std::uint64_t id, bool is_incremental) {
  ProtoMessage message;
  message.integer(clock_snapshot::kId, id);
  message.integer(clock_snapshot::kTimestamp, 0);
  if (is_incremental) message.integer(clock_snapshot::kIsIncremental, 1);
  return message;
}

// Both clocks show 0: the first time of a sequence counts from power-up, the next ones from the packet before.
ProtoMessage clocks() {
  ProtoMessage message;
  message.message(clock_snapshot::kClock, clock(clock_snapshot::kBootTime, false));
  message.message(clock_snapshot::kClock, clock(clock_snapshot::kOfSequence, true));
  message.integer(clock_snapshot::kPrimary, clock_snapshot::kBootTime);
  return message;
}

ProtoMessage descriptor(const PerfettoTrack::Description& track) {
  using Kind = PerfettoTrack::Kind;
  ProtoMessage message;
  message.integer(track_descriptor::kUuid, track.uuid);
  if (track.kind == Kind::kProcess) {
    ProtoMessage process;
    process.integer(track_descriptor::kPid, 1);
    process.text(track_descriptor::kProcessName, track.name);
    message.message(track_descriptor::kProcess, process);
    return message;
  }
  message.text(track_descriptor::kName, track.name);
  message.integer(track_descriptor::kParent, track.parent);
  message.integer(track_descriptor::kRank, track.rank);
  if (track.kind == Kind::kGroup) message.integer(track_descriptor::kChildOrder, track_descriptor::kByRank);
  if (track.kind == Kind::kCounter) {
    ProtoMessage counter;
    counter.text(track_descriptor::kUnitName, track.unit);
    message.message(track_descriptor::kCounter, counter);
  }
  return message;
}

}  // namespace

std::string perfetto_mark() {
  ProtoMessage event;
  event.text(trace_packet::kText, "trace of stereotlm");
  ProtoMessage packet;
  packet.message(trace_packet::kForTesting, event);
  ProtoMessage file;
  file.message(trace_file::kPacket, packet);
  return file.bytes();
}

PerfettoTrack::PerfettoTrack(files::OutputFile& file, const Description& description)
    : file_(file), uuid_(description.uuid) {
  packet_.message(trace_packet::kTrackDescriptor, descriptor(description));
  write_packet();
  if (description.kind == Kind::kSlices || description.kind == Kind::kCounter) start_sequence();
}

// Begins with empty tables of names. The uuid of the track serves as the number of the sequence.
void PerfettoTrack::start_sequence() {
  event_names_.clear();
  argument_names_.clear();
  last_ns_ = 0;
  ProtoMessage event_defaults;
  event_defaults.integer(track_event::kTrack, uuid_);
  ProtoMessage defaults;
  defaults.integer(trace_packet::kDefaultClock, clock_snapshot::kOfSequence);
  defaults.message(trace_packet::kTrackEvent, event_defaults);
  packet_.integer(trace_packet::kSequence, uuid_);
  packet_.integer(trace_packet::kSequenceFlags, trace_packet::kStateCleared);
  packet_.message(trace_packet::kClockSnapshot, clocks());
  packet_.message(trace_packet::kDefaults, defaults);
  write_packet();
}

// The number of a name in its table, which is a field of the interned data. A new name goes into the packet.
std::uint64_t PerfettoTrack::number_of(Names& names, std::uint32_t field, std::string_view name) {
  const auto [entry, is_new] = names.try_emplace(std::string(name), names.size() + 1);
  if (is_new) {
    ProtoMessage message;
    message.integer(interned::kNumber, entry->second);
    message.text(interned::kName, name);
    interned_.message(field, message);
  }
  return entry->second;
}

void PerfettoTrack::begin(std::uint64_t time_ns, std::string_view name, Arguments arguments,
                          const std::vector<std::uint64_t>& flows) {
  if (event_names_.size() >= kMostNames) start_sequence();
  event_.integer(track_event::kName, number_of(event_names_, interned::kEventNames, name));
  add_arguments(arguments);
  for (const std::uint64_t flow : flows) event_.fixed(track_event::kFlow, flow);
  write_event(time_ns, track_event::kBegin);
}

void PerfettoTrack::add_arguments(Arguments arguments) {
  for (const Argument& argument : arguments) {
    if (!argument.value) continue;
    ProtoMessage message;
    message.integer(argument::kName, number_of(argument_names_, interned::kArgumentNames, argument.name));
    message.integer(argument::kNumber, *argument.value);
    event_.message(track_event::kArgument, message);
  }
}

void PerfettoTrack::end(std::uint64_t time_ns) { write_event(time_ns, track_event::kEnd); }

void PerfettoTrack::instant(std::uint64_t time_ns, std::string_view name, Arguments arguments) {
  event_.integer(track_event::kName, number_of(event_names_, interned::kEventNames, name));
  add_arguments(arguments);
  write_event(time_ns, track_event::kInstant);
}

void PerfettoTrack::count(std::uint64_t time_ns, double value) {
  if (value == last_value_) return;
  last_value_ = value;
  const auto whole = static_cast<std::uint64_t>(value);
  if (static_cast<double>(whole) == value)
    event_.integer(track_event::kCounter, whole);
  else
    event_.real(track_event::kDoubleCounter, value);
  write_event(time_ns, track_event::kCount);
}

void PerfettoTrack::write_event(std::uint64_t time_ns, std::uint64_t type) {
  event_.integer(track_event::kType, type);
  packet_.integer(trace_packet::kTimestamp, time_ns - last_ns_);
  last_ns_ = time_ns;
  packet_.integer(trace_packet::kSequence, uuid_);
  packet_.integer(trace_packet::kSequenceFlags, trace_packet::kNeedsState);
  if (!interned_.empty()) packet_.message(trace_packet::kInternedData, interned_);
  packet_.message(trace_packet::kTrackEvent, event_);
  write_packet();
  interned_.clear();
  event_.clear();
}

void PerfettoTrack::write_packet() {
  ProtoMessage file;
  file.message(trace_file::kPacket, packet_);
  file_.write(file.bytes());
  packet_.clear();
}

}  // namespace stereotlm::trace
