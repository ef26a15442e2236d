#include "sw/trace/perfetto_file.h"

#include <cstring>
#include <utility>

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

constexpr std::uint64_t kProcessUuid = 1;

ProtoMessage clock(std::uint64_t id, bool is_incremental) {
  ProtoMessage message;
  message.integer(clock_snapshot::kId, id);
  message.integer(clock_snapshot::kTimestamp, 0);
  if (is_incremental) message.integer(clock_snapshot::kIsIncremental, 1);
  return message;
}

// Both clocks show 0: the first time of a sequence counts from power-up, the next ones from the packet
// before.
ProtoMessage clocks() {
  ProtoMessage message;
  message.message(clock_snapshot::kClock, clock(clock_snapshot::kBootTime, false));
  message.message(clock_snapshot::kClock, clock(clock_snapshot::kOfSequence, true));
  message.integer(clock_snapshot::kPrimary, clock_snapshot::kBootTime);
  return message;
}

// The descriptor of a track or of a group.
ProtoMessage descriptor(std::uint64_t uuid, std::uint64_t parent, std::size_t rank, const std::string& name) {
  ProtoMessage message;
  message.integer(track_descriptor::kUuid, uuid);
  message.text(track_descriptor::kName, name);
  message.integer(track_descriptor::kParent, parent);
  message.integer(track_descriptor::kRank, rank);
  return message;
}

}  // namespace

void ProtoMessage::integer(std::uint32_t field, std::uint64_t value) {
  varint(field << 3U);
  varint(value);
}

void ProtoMessage::fixed(std::uint32_t field, std::uint64_t value) {
  varint(field << 3U | 1U);
  for (unsigned byte = 0; byte < 8; ++byte) bytes_ += static_cast<char>(value >> (8U * byte));
}

void ProtoMessage::real(std::uint32_t field, double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  fixed(field, bits);
}

void ProtoMessage::text(std::uint32_t field, std::string_view text) {
  varint(field << 3U | 2U);
  varint(text.size());
  bytes_ += text;
}

void ProtoMessage::varint(std::uint64_t value) {
  constexpr std::uint64_t kMore = 0x80;
  for (; value >= kMore; value >>= 7U) bytes_ += static_cast<char>(value | kMore);
  bytes_ += static_cast<char>(value);
}

std::string perfetto_mark() {
  ProtoMessage event;
  event.text(trace_packet::kText, "trace of stereotlm");
  ProtoMessage packet;
  packet.message(trace_packet::kForTesting, event);
  ProtoMessage file;
  file.message(trace_file::kPacket, packet);
  return file.bytes();
}

PerfettoFile::PerfettoFile(files::OutputFile& file, const std::string& process)
    : file_(file), last_uuid_(kProcessUuid) {
  file_.write(perfetto_mark());
  ProtoMessage of_process;
  of_process.integer(track_descriptor::kPid, 1);
  of_process.text(track_descriptor::kProcessName, process);
  ProtoMessage track;
  track.integer(track_descriptor::kUuid, kProcessUuid);
  track.message(track_descriptor::kProcess, of_process);
  ProtoMessage packet;
  packet.message(trace_packet::kTrackDescriptor, track);
  write(packet);
}

std::uint64_t PerfettoFile::add(TrackGroup group, std::size_t rank, const std::string& name,
                                const std::string& unit) {
  const auto place = static_cast<std::size_t>(group);
  ProtoMessage packet;
  if (groups_[place] == 0) {
    groups_[place] = ++last_uuid_;
    ProtoMessage message = descriptor(groups_[place], kProcessUuid, place, kTrackGroupNames[place]);
    message.integer(track_descriptor::kChildOrder, track_descriptor::kByRank);
    packet.message(trace_packet::kTrackDescriptor, message);
    write(packet);
  }
  ProtoMessage message = descriptor(++last_uuid_, groups_[place], rank, name);
  if (!unit.empty()) {
    ProtoMessage counter;
    counter.text(track_descriptor::kUnitName, unit);
    message.message(track_descriptor::kCounter, counter);
  }
  packet.message(trace_packet::kTrackDescriptor, message);
  write(packet);
  return last_uuid_;
}

// Clears the packet.
void PerfettoFile::write(ProtoMessage& packet) {
  ProtoMessage file;
  file.message(trace_file::kPacket, packet);
  file_.write(file.bytes());
  packet.clear();
}

PerfettoTrack::PerfettoTrack(PerfettoFile& file, TrackGroup group, std::size_t rank, std::string name,
                             std::string unit)
    : file_(file), group_(group), rank_(rank), name_(std::move(name)), unit_(std::move(unit)) {}

void PerfettoTrack::open() {
  if (is_written()) return;
  uuid_ = file_.add(group_, rank_, name_, unit_);
  start_sequence();
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
  file_.write(packet_);
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

void PerfettoTrack::add_name(std::string_view name, Arguments arguments) {
  open();
  if (event_names_.size() >= kMostNames) start_sequence();
  event_.integer(track_event::kName, number_of(event_names_, interned::kEventNames, name));
  for (const Argument& argument : arguments) {
    if (!argument.value) continue;
    ProtoMessage message;
    message.integer(argument::kName, number_of(argument_names_, interned::kArgumentNames, argument.name));
    message.integer(argument::kNumber, *argument.value);
    event_.message(track_event::kArgument, message);
  }
}

void PerfettoTrack::begin(std::uint64_t time_ns, std::string_view name, Arguments arguments,
                          const Flows& flows) {
  add_name(name, arguments);
  for (const std::uint64_t flow : flows) event_.fixed(track_event::kFlow, flow);
  write_event(time_ns, track_event::kBegin);
}

void PerfettoTrack::end(std::uint64_t time_ns) { write_event(time_ns, track_event::kEnd); }

void PerfettoTrack::instant(std::uint64_t time_ns, std::string_view name, Arguments arguments) {
  add_name(name, arguments);
  write_event(time_ns, track_event::kInstant);
}

void PerfettoTrack::count(std::uint64_t time_ns, double value) {
  if (value == last_value_) return;
  last_value_ = value;
  open();
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
  file_.write(packet_);
  interned_.clear();
  event_.clear();
}

PerfettoTrack& OverlappingTracks::free_at(std::uint64_t begin_ns) {
  for (PerfettoTrack& track : tracks_) {
    if (track.last_ns() <= begin_ns) return track;
  }
  return tracks_.emplace_back(first_);
}

}  // namespace stereotlm::trace
