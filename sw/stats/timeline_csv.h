#pragma once

#include <string>
#include <vector>

#include "platform/timeline_records.h"

namespace stereotlm::stats {

// The lines of timeline.csv and of latency.csv. README.md describes the columns. The heads are lines of their
// own.
std::string timeline_csv_head();
std::string timeline_csv(const std::vector<platform::TimelineEvent>& events);
std::string latency_csv_head();
std::string latency_csv(const std::vector<platform::FrameLatency>& latencies);

}  // namespace stereotlm::stats
