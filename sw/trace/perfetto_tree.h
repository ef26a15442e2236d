#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "sw/files/output_file.h"
#include "sw/trace/perfetto_track.h"

namespace stereotlm::trace {

// The groups of tracks, from top to bottom.
enum class TrackGroup : std::uint8_t { kCore, kPorts, kBanks, kQueues, kBuses, kCapture, kSoftware };
inline constexpr std::array<const char*, 7> kTrackGroupNames = {"core",  "ports",   "banks",   "queues",
                                                                "buses", "capture", "software"};

// All tracks of a file. A group is written with its first track.
class PerfettoTree {
 public:
  PerfettoTree(files::OutputFile& file, const std::string& process);

  // A new track. `rank` orders the tracks of a group.
  PerfettoTrack& add_slices(TrackGroup group, std::size_t rank, const std::string& name);
  PerfettoTrack& add_counter(TrackGroup group, std::size_t rank, const std::string& name,
                             const std::string& unit);

 private:
  static constexpr std::uint64_t kProcess = 1;  // uuid

  PerfettoTrack& add(PerfettoTrack::Description description, TrackGroup group);

  files::OutputFile& file_;
  std::uint64_t last_uuid_ = kProcess;
  std::array<std::uint64_t, kTrackGroupNames.size()> groups_{};  // uuid; 0: not written
  std::deque<PerfettoTrack> tracks_;
};

// A track that is written when its first event comes.
class LazyTrack {
 public:
  LazyTrack(PerfettoTree& tree, TrackGroup group, std::size_t rank, std::string name, std::string unit = {})
      : tree_(tree), group_(group), rank_(rank), name_(std::move(name)), unit_(std::move(unit)) {}

  PerfettoTrack* operator->() { return &get(); }
  PerfettoTrack& get() {
    if (track_ == nullptr) track_ = &add();
    return *track_;
  }
  bool is_written() const { return track_ != nullptr; }

 private:
  PerfettoTrack& add() {
    return unit_.empty() ? tree_.add_slices(group_, rank_, name_)
                         : tree_.add_counter(group_, rank_, name_, unit_);
  }

  PerfettoTree& tree_;
  TrackGroup group_;
  std::size_t rank_;
  std::string name_;
  std::string unit_;  // of a counter
  PerfettoTrack* track_ = nullptr;
};

// Tracks of one name, which Perfetto shows as one. Slices that overlap without being nested need several. The
// slices come by their ends.
class OverlappingTracks {
 public:
  OverlappingTracks(PerfettoTree& tree, TrackGroup group, std::size_t rank, std::string name)
      : tree_(tree), group_(group), rank_(rank), name_(std::move(name)) {}

  // A track whose last slice has ended by then.
  PerfettoTrack& free_at(std::uint64_t begin_ns);

 private:
  PerfettoTree& tree_;
  TrackGroup group_;
  std::size_t rank_;
  std::string name_;
  std::vector<PerfettoTrack*> tracks_;
};

}  // namespace stereotlm::trace
