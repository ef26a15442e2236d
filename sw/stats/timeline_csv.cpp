#include "sw/stats/timeline_csv.h"

#include <fmt/format.h>

#include <iterator>
#include <optional>

namespace stereotlm::stats {
namespace {

std::string text_of(const std::optional<std::uint64_t>& number) {
  return number ? fmt::to_string(*number) : std::string();
}

}  // namespace

std::string timeline_csv_head() {
  return "kind,class,frame,camera_frame,start_ps,end_ps,words,dropped_pixels,why\n";
}

std::string timeline_csv(const std::vector<platform::TimelineEvent>& events) {
  std::string text;
  for (const platform::TimelineEvent& event : events) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{}\n",
                   platform::kEventKindNames[static_cast<std::size_t>(event.kind)], event.what,
                   text_of(event.frame), text_of(event.camera_frame), event.begin_ps, event.end_ps,
                   event.words, event.dropped_pixels, event.why);
  }
  return text;
}

std::string latency_csv_head() {
  return fmt::format("frame,camera_frame,captured_ps,{}_ps,latency_ps\n",
                     fmt::join(platform::kLatencyParts, "_ps,"));
}

std::string latency_csv(const std::vector<platform::FrameLatency>& latencies) {
  std::string text;
  for (const platform::FrameLatency& latency : latencies) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", latency.frame, latency.camera_frame,
                   latency.begin_ps, fmt::join(latency.parts_ps, ","), latency.sum_ps());
  }
  return text;
}

}  // namespace stereotlm::stats
