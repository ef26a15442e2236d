#include "sw/trace/perfetto_file.h"

#include <cstring>
#include <utility>

namespace stereotlm::trace {
namespace {

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

// The descriptor of a track or of a group.
ProtoMessage described(std::uint64_t uuid, std::uint64_t parent, std::size_t rank, const std::string& name) {
  return ProtoMessage()
      .integer(descriptor::kUuid, uuid)
      .text(descriptor::kName, name)
      .integer(descriptor::kParent, parent)
      .integer(descriptor::kRank, rank);
}

}  // namespace

std::string perfetto_mark() {
  const ProtoMessage event = ProtoMessage().text(1, "trace of stereotlm");  // TestEvent.str
  const ProtoMessage packet = ProtoMessage().text(packet::kForTesting, event);
  return std::string(ProtoMessage().text(kPacket, packet));
}

PerfettoFile::PerfettoFile(files::OutputFile& file, const std::string& process)
    : file_(file), last_uuid_(kProcessUuid) {
  file_.write(perfetto_mark());
  const ProtoMessage of_process =
      ProtoMessage().integer(descriptor::kPid, 1).text(descriptor::kProcessName, process);
  const ProtoMessage track =
      ProtoMessage().integer(descriptor::kUuid, kProcessUuid).text(descriptor::kProcess, of_process);
  write(ProtoMessage().text(packet::kTrackDescriptor, track));
}

std::uint64_t PerfettoFile::add(TrackGroup group, std::size_t rank, const std::string& name,
                                const std::string& unit) {
  const auto place = static_cast<std::size_t>(group);
  if (groups_[place] == 0) {
    groups_[place] = ++last_uuid_;
    ProtoMessage message = described(groups_[place], kProcessUuid, place, kTrackGroupNames[place]);
    message.integer(descriptor::kChildOrder, descriptor::kByRank);
    write(ProtoMessage().text(packet::kTrackDescriptor, message));
  }
  ProtoMessage track = described(++last_uuid_, groups_[place], rank, name);
  if (!unit.empty()) track.text(descriptor::kCounter, ProtoMessage().text(descriptor::kUnitName, unit));
  write(ProtoMessage().text(packet::kTrackDescriptor, track));
  return last_uuid_;
}

void PerfettoFile::write(std::string_view packet) {
  packet_.clear();
  file_.write(packet_.text(kPacket, packet));
}

PerfettoTrack::PerfettoTrack(PerfettoFile& file, TrackGroup group, std::size_t rank, std::string name,
                             std::string unit)
    : file_(file), group_(group), rank_(rank), name_(std::move(name)), unit_(std::move(unit)) {}

// Begins with empty tables of names. The uuid of the track serves as the number of the sequence. Both clocks
// show 0: the first time of a sequence counts from power-up, the next ones from the packet before.
void PerfettoTrack::start_sequence() {
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
  const ProtoMessage defaults = ProtoMessage()
                                    .integer(packet::kDefaultClock, clocks::kOfSequence)
                                    .text(packet::kTrackEvent, ProtoMessage().integer(event::kTrack, uuid_));
  file_.write(ProtoMessage()
                  .integer(packet::kSequence, uuid_)
                  .integer(packet::kSequenceFlags, packet::kStateCleared)
                  .text(packet::kClockSnapshot, snapshot)
                  .text(packet::kDefaults, defaults));
}

std::uint64_t PerfettoTrack::number_of(std::uint32_t table, std::string_view name) {
  auto& names = names_[table - interned::kEventNames];
  const auto [entry, is_new] = names.try_emplace(std::string(name), names.size() + 1);
  if (is_new) {
    interned_.text(table,
                   ProtoMessage().integer(interned::kNumber, entry->second).text(interned::kName, name));
  }
  return entry->second;
}

void PerfettoTrack::begin(std::uint64_t time_ns, std::string_view name, Arguments arguments,
                          const Flows& flows) {
  for (const std::uint64_t flow : flows) event_.fixed(event::kFlow, flow);
  write_event(time_ns, event::kBegin, name, arguments);
}

void PerfettoTrack::end(std::uint64_t time_ns) { write_event(time_ns, event::kEnd); }

void PerfettoTrack::instant(std::uint64_t time_ns, std::string_view name, Arguments arguments) {
  write_event(time_ns, event::kInstant, name, arguments);
}

void PerfettoTrack::count(std::uint64_t time_ns, double value) {
  if (value == last_value_) return;
  last_value_ = value;
  const auto whole = static_cast<std::uint64_t>(value);
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  static_cast<double>(whole) == value ? event_.integer(event::kCounter, whole)
                                      : event_.fixed(event::kDoubleCounter, bits);
  write_event(time_ns, event::kCount);
}

void PerfettoTrack::write_event(std::uint64_t time_ns, std::uint64_t type, std::string_view name,
                                Arguments arguments) {
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

}  // namespace stereotlm::trace
