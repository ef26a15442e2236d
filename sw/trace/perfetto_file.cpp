#include "sw/trace/perfetto_file.h"

#include <cstring>
#include <utility>

namespace stereotlm::trace {
namespace {

// The fields of a message of Protocol Buffers, in its wire format. A message is the text of its fields.
std::string varint(std::uint64_t value) {
  constexpr std::uint64_t kMore = 0x80;
  std::string bytes;
  for (; value >= kMore; value >>= 7U) bytes += static_cast<char>(value | kMore);
  return bytes += static_cast<char>(value);
}
std::string integer(std::uint32_t field, std::uint64_t value) { return varint(field << 3U) + varint(value); }
std::string fixed(std::uint32_t field, std::uint64_t value) {
  std::string bytes = varint(field << 3U | 1U);
  for (unsigned byte = 0; byte < 8; ++byte) bytes += static_cast<char>(value >> (8U * byte));
  return bytes;
}
std::string text(std::uint32_t field, std::string_view value) {
  return varint(field << 3U | 2U) + varint(value.size()).append(value);
}

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
std::string described(std::uint64_t uuid, std::uint64_t parent, std::size_t rank, const std::string& name) {
  return integer(descriptor::kUuid, uuid) + text(descriptor::kName, name) +
         integer(descriptor::kParent, parent) + integer(descriptor::kRank, rank);
}

}  // namespace

std::string perfetto_mark() {
  return text(kPacket, text(packet::kForTesting, text(1, "trace of stereotlm")));  // TestEvent.str
}

PerfettoFile::PerfettoFile(files::OutputFile& file, const std::string& process)
    : file_(file), last_uuid_(kProcessUuid) {
  file_.write(perfetto_mark());
  const std::string of_process = integer(descriptor::kPid, 1) + text(descriptor::kProcessName, process);
  write(text(packet::kTrackDescriptor,
             integer(descriptor::kUuid, kProcessUuid) + text(descriptor::kProcess, of_process)));
}

std::uint64_t PerfettoFile::add(TrackGroup group, std::size_t rank, const std::string& name,
                                const std::string& unit) {
  const auto place = static_cast<std::size_t>(group);
  if (groups_[place] == 0) {
    groups_[place] = ++last_uuid_;
    write(text(packet::kTrackDescriptor,
               described(groups_[place], kProcessUuid, place, kTrackGroupNames[place]) +
                   integer(descriptor::kChildOrder, descriptor::kByRank)));
  }
  std::string track = described(++last_uuid_, groups_[place], rank, name);
  if (!unit.empty()) track += text(descriptor::kCounter, text(descriptor::kUnitName, unit));
  write(text(packet::kTrackDescriptor, track));
  return last_uuid_;
}

void PerfettoFile::write(const std::string& packet) { file_.write(text(kPacket, packet)); }

PerfettoTrack::PerfettoTrack(PerfettoFile& file, TrackGroup group, std::size_t rank, std::string name,
                             std::string unit)
    : file_(file), group_(group), rank_(rank), name_(std::move(name)), unit_(std::move(unit)) {}

// Begins with empty tables of names. The uuid of the track serves as the number of the sequence. Both clocks
// show 0: the first time of a sequence counts from power-up, the next ones from the packet before.
void PerfettoTrack::start_sequence() {
  names_ = {};
  last_ns_ = 0;
  const std::string boot_time = integer(clocks::kId, clocks::kBootTime) + integer(clocks::kTimestamp, 0);
  const std::string of_sequence = integer(clocks::kId, clocks::kOfSequence) + integer(clocks::kTimestamp, 0) +
                                  integer(clocks::kIsIncremental, 1);
  file_.write(integer(packet::kSequence, uuid_) + integer(packet::kSequenceFlags, packet::kStateCleared) +
              text(packet::kClockSnapshot, text(clocks::kClock, boot_time) +
                                               text(clocks::kClock, of_sequence) +
                                               integer(clocks::kPrimary, clocks::kBootTime)) +
              text(packet::kDefaults, integer(packet::kDefaultClock, clocks::kOfSequence) +
                                          text(packet::kTrackEvent, integer(event::kTrack, uuid_))));
}

std::uint64_t PerfettoTrack::number_of(std::uint32_t table, std::string_view name) {
  auto& names = names_[table - interned::kEventNames];
  const auto [entry, is_new] = names.try_emplace(std::string(name), names.size() + 1);
  if (is_new)
    interned_ += text(table, integer(interned::kNumber, entry->second) + text(interned::kName, name));
  return entry->second;
}

void PerfettoTrack::begin(std::uint64_t time_ns, std::string_view name, Arguments arguments,
                          const Flows& flows) {
  std::string fields;
  for (const std::uint64_t flow : flows) fields += fixed(event::kFlow, flow);
  write_event(time_ns, event::kBegin, name, arguments, fields);
}

void PerfettoTrack::end(std::uint64_t time_ns) { write_event(time_ns, event::kEnd, {}, {}, {}); }

void PerfettoTrack::instant(std::uint64_t time_ns, std::string_view name, Arguments arguments) {
  write_event(time_ns, event::kInstant, name, arguments, {});
}

void PerfettoTrack::count(std::uint64_t time_ns, double value) {
  if (value == last_value_) return;
  last_value_ = value;
  const auto whole = static_cast<std::uint64_t>(value);
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  write_event(time_ns, event::kCount, {}, {},
              static_cast<double>(whole) == value ? integer(event::kCounter, whole)
                                                  : fixed(event::kDoubleCounter, bits));
}

void PerfettoTrack::write_event(std::uint64_t time_ns, std::uint64_t type, std::string_view name,
                                Arguments arguments, const std::string& fields) {
  const bool is_new = !is_written();
  if (is_new) uuid_ = file_.add(group_, rank_, name_, unit_);
  if (is_new || (!name.empty() && names_[0].size() >= kMostNames)) start_sequence();
  interned_.clear();
  std::string bytes;
  if (!name.empty()) bytes = integer(event::kName, number_of(interned::kEventNames, name));
  for (const Argument& argument : arguments) {
    if (!argument.value) continue;
    bytes += text(event::kArgument,
                  integer(event::kArgumentName, number_of(interned::kArgumentNames, argument.name)) +
                      integer(event::kNumber, *argument.value));
  }
  bytes += fields + integer(event::kType, type);
  std::string packet = integer(packet::kTimestamp, time_ns - last_ns_) + integer(packet::kSequence, uuid_) +
                       integer(packet::kSequenceFlags, packet::kNeedsState);
  if (!interned_.empty()) packet += text(packet::kInternedData, interned_);
  file_.write(packet + text(packet::kTrackEvent, bytes));
  last_ns_ = time_ns;
}

}  // namespace stereotlm::trace
