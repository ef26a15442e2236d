#include "sw/trace/perfetto_tree.h"

#include <utility>

namespace stereotlm::trace {

using Kind = PerfettoTrack::Kind;

PerfettoTree::PerfettoTree(files::OutputFile& file, const std::string& process) : file_(file) {
  file_.write(perfetto_mark());
  tracks_.emplace_back(file_, PerfettoTrack::Description{Kind::kProcess, kProcess, 0, 0, process});
}

PerfettoTrack& PerfettoTree::add_slices(TrackGroup group, std::size_t rank, const std::string& name) {
  return add({Kind::kSlices, 0, 0, rank, name}, group);
}

PerfettoTrack& PerfettoTree::add_counter(TrackGroup group, std::size_t rank, const std::string& name,
                                         const std::string& unit) {
  return add({Kind::kCounter, 0, 0, rank, name, unit}, group);
}

PerfettoTrack& PerfettoTree::add(PerfettoTrack::Description description, TrackGroup group) {
  const auto place = static_cast<std::size_t>(group);
  if (groups_[place] == 0) {
    groups_[place] = ++last_uuid_;
    tracks_.emplace_back(file_, PerfettoTrack::Description{Kind::kGroup, groups_[place], kProcess, place,
                                                           kTrackGroupNames[place]});
  }
  description.uuid = ++last_uuid_;
  description.parent = groups_[place];
  return tracks_.emplace_back(file_, description);
}

PerfettoTrack& OverlappingTracks::free_at(std::uint64_t begin_ns) {
  for (PerfettoTrack* const track : tracks_) {
    if (track->last_ns() <= begin_ns) return *track;
  }
  return *tracks_.emplace_back(&tree_.add_slices(group_, rank_, name_));
}

}  // namespace stereotlm::trace
