#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "sw/files/output_file.h"

namespace stereotlm::trace {

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

// The first packet of every file, by which the file is known: a text that viewers ignore.
std::string perfetto_mark();

// The groups of tracks, from top to bottom.
enum class TrackGroup : std::uint8_t { kCore, kPorts, kBanks, kQueues, kBuses, kCapture, kSoftware };
inline constexpr std::array<const char*, 7> kTrackGroupNames = {"core",  "ports",   "banks",   "queues",
                                                                "buses", "capture", "software"};

// A trace of Perfetto: a process, and below it groups of tracks. A group is written with its first track.
class PerfettoFile {
 public:
  PerfettoFile(files::OutputFile& file, const std::string& process);

 private:
  friend class PerfettoTrack;

  // Describes a track, and its group if that is new. Returns the uuid of the track.
  std::uint64_t add(TrackGroup group, std::size_t rank, const std::string& name, const std::string& unit);
  void write(std::string_view packet);

  files::OutputFile& file_;
  ProtoMessage packet_;
  std::uint64_t last_uuid_;
  std::array<std::uint64_t, kTrackGroupNames.size()> groups_{};  // uuid; 0: not written
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
                std::string unit = {});

  // Times are in ns. An arrow leads from each slice to the next one with the same flow.
  void begin(std::uint64_t time_ns, std::string_view name, Arguments arguments, const Flows& flows = {});
  void end(std::uint64_t time_ns);
  void slice(std::uint64_t begin_ns, std::uint64_t end_ns, std::string_view name, Arguments arguments,
             const Flows& flows = {}) {
    begin(begin_ns, name, arguments, flows);
    end(end_ns);
  }
  void instant(std::uint64_t time_ns, std::string_view name, Arguments arguments);
  // Writes the value if it differs from the last one.
  void count(std::uint64_t time_ns, double value);

  std::uint64_t last_ns() const { return last_ns_; }
  bool is_written() const { return uuid_ != 0; }

 private:
  // A table that has become larger is begun anew, so that memory does not grow with the run.
  static constexpr std::size_t kMostNames = 4096;

  void start_sequence();
  // The number of a name in its table, which is a field of the interned data. A new name goes into the packet.
  std::uint64_t number_of(std::uint32_t table, std::string_view name);
  // Writes the event with these fields too, and clears it.
  void write_event(std::uint64_t time_ns, std::uint64_t type, std::string_view name = {},
                   Arguments arguments = {});

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
// slices come by their ends.
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

}  // namespace stereotlm::trace
