#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>

#include "platform/audit.h"
#include "platform/bounds.h"
#include "platform/figures.h"
#include "platform/timeline_records.h"
#include "sw/report/page_data/recording_data.h"
#include "sw/stats/record_csv.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

// Columns of timeline.csv and of latency.csv.
enum EventColumn : std::size_t { kKind, kClass, kFrame, kCameraFrame, kStart, kEnd, kWords, kPixels, kWhy };
enum LatencyColumn : std::size_t { kLatencyFrame, kLatencyCameraFrame, kCaptured, kFirstPart };

const char* name_of(platform::EventKind kind) {
  return platform::kEventKindNames[static_cast<std::size_t>(kind)];
}

// -1: none.
std::int64_t number_of(const std::optional<std::uint64_t>& frame) {
  return frame ? static_cast<std::int64_t>(*frame) : -1;
}

double real(std::uint64_t number) { return static_cast<double>(number); }

// The names of the columns in the head of a file.
std::vector<std::string> names_of(const std::string& head) {
  std::istringstream line(head.substr(0, head.find('\n')));
  std::vector<std::string> names;
  for (std::string name; std::getline(line, name, ',');) names.push_back(name);
  return names;
}

}  // namespace

TimelineData::TimelineData(const platform::BoardConfig& board, const std::filesystem::path& folder)
    : events_csv_((folder / "timeline.csv").string(), stats::timeline_csv_head()),
      latencies_csv_((folder / "latency.csv").string(), stats::latency_csv_head()),
      board_(board) {}

// An event with the names of the line.
platform::TimelineEvent TimelineData::event_of_line() const {
  const std::string_view kind = events_csv_.cell(kKind);
  const std::string_view why = events_csv_.cell(kWhy);
  for (const platform::EventName& known : platform::kEventNames) {
    if (kind == name_of(known.kind) && events_csv_.cell(kClass) == known.what && why == known.why)
      return {known.kind, known.what, {}, {}, 0, 0, 0, 0, known.why};
  }
  events_csv_.refuse(kClass, fmt::format("must be a class of {} with why = {}", kind, why));
}

void TimelineData::add_events(std::string_view text) {
  events_csv_.read(text, [this] {
    const auto number = [this](EventColumn column, std::uint64_t least = 0) {
      return events_csv_.number(column, INT64_MAX, least);
    };
    const auto number_if_any = [&](EventColumn column) {
      return events_csv_.cell(column).empty() ? std::nullopt : std::optional(number(column));
    };
    platform::TimelineEvent event = event_of_line();
    event.frame = number_if_any(kFrame);
    event.camera_frame = number_if_any(kCameraFrame);
    event.begin_ps = number(kStart);
    event.end_ps = number(kEnd, std::max(event.begin_ps, end_ps()));
    const bool is_capture = event.kind == platform::EventKind::kCapture;
    const bool moves = is_capture || event.kind == platform::EventKind::kUpload ||
                       event.kind == platform::EventKind::kReadBack || events_csv_.cell(kClass) == "cycles";
    event.words = events_csv_.number(kWords, moves ? INT64_MAX : 0);
    event.dropped_pixels = events_csv_.number(kPixels, is_capture ? INT64_MAX : 0);
    events_.push_back(event);
  });
}

void TimelineData::add_latencies(std::string_view text) {
  latencies_csv_.read(text, [this] {
    Latency latency;
    for (std::size_t column = 0; column < latency.size(); ++column)
      latency[column] = latencies_csv_.number(column);
    latencies_csv_.number(kLatencyFrame, latencies_.size(), latencies_.size());
    const std::uint64_t sum =
        std::accumulate(latency.begin() + kFirstPart, latency.end() - 1, std::uint64_t{0});
    latencies_csv_.number(latency.size() - 1, sum, sum);
    latencies_.push_back(latency);
  });
}

void TimelineData::check(const platform::Statistics& statistics) const {
  platform::Audit of_latencies;
  of_latencies.equal("recorded: latencies", latencies_.size(), "frames", statistics.frames);
  latencies_csv_.finish(of_latencies);
  platform::Audit of_events;
  platform::TimelineSums sums(board_);
  for (const platform::TimelineEvent& event : events_) {
    sums.add(event);
    if (!event.frame || *event.frame >= latencies_.size()) continue;
    of_events.equal(fmt::format("recorded: frame {}: camera_frame", *event.frame),
                    event.camera_frame.value_or(UINT64_MAX), "that in latency.csv",
                    latencies_[static_cast<std::size_t>(*event.frame)][kLatencyCameraFrame]);
  }
  sums.check(statistics, of_events);
  events_csv_.finish(of_events);
  std::vector<platform::Delivery> deliveries;
  for (const Latency& latency : latencies_)
    deliveries.push_back({latency[kCaptured], latency[kCaptured] + latency.back()});
  platform::Statistics derived = statistics;
  platform::derive_delivery_figures(deliveries, platform::allocation_period_frames(board_), derived);
  platform::Audit of_figures;
  for (const std::string& difference :
       stats::stats_differences(stats::stats_json(statistics, {}), stats::stats_json(derived, {}),
                                "stats.json", "from the latencies"))
    of_figures.fail("recorded: " + difference);
  latencies_csv_.finish(of_figures);
}

// All of a run with few events. Otherwise its beginning, the time around its slowest frame, and its end.
std::vector<TimelineData::Period> TimelineData::periods() const {
  if (events_.size() <= kMostEvents) return {{0, end_ps()}};
  constexpr std::size_t kPart = kMostEvents / 3;
  const auto end_of = [this](std::size_t event) {
    return events_[std::min(event, events_.size() - 1)].end_ps;
  };
  std::vector<Period> found = {{0, end_of(kPart)}, {end_of(events_.size() - kPart), end_ps()}};
  const auto slowest =
      std::max_element(latencies_.begin(), latencies_.end(),
                       [](const Latency& a, const Latency& b) { return a.back() < b.back(); });
  if (slowest != latencies_.end()) {
    const std::uint64_t middle_ps = (*slowest)[kCaptured] + slowest->back() / 2;
    const auto at = std::lower_bound(
        events_.begin(), events_.end(), middle_ps,
        [](const platform::TimelineEvent& event, std::uint64_t time_ps) { return event.end_ps < time_ps; });
    const auto middle = static_cast<std::size_t>(at - events_.begin());
    found.emplace_back(end_of(middle - std::min(middle, kPart / 2)), end_of(middle + kPart / 2));
  }
  std::sort(found.begin(), found.end());
  std::vector<Period> apart;
  for (const Period& period : found) {
    if (!apart.empty() && period.first <= apart.back().second) {
      apart.back().second = std::max(apart.back().second, period.second);
    } else {
      apart.push_back(period);
    }
  }
  return apart;
}

Json TimelineData::events_json() const {
  const std::vector<Period> shown = periods();
  Json rows = Json::array();
  for (const platform::TimelineEvent& event : events_) {
    const bool is_shown = std::any_of(shown.begin(), shown.end(), [&event](const Period& period) {
      return event.end_ps >= period.first && event.begin_ps <= period.second;
    });
    if (is_shown) {
      rows.push_back({name_of(event.kind), event.what, number_of(event.frame), number_of(event.camera_frame),
                      event.begin_ps, event.end_ps, event.words, event.dropped_pixels, event.why});
    }
  }
  Json json = {
      {"names", names_of(stats::timeline_csv_head())}, {"rows", std::move(rows)}, {"all", events_.size()}};
  json["periods_ps"] = Json::array();
  for (const auto& [begin, end] : shown) json["periods_ps"].push_back({begin, end});
  return json;
}

// Of captures, transfers and cycles of the core: how much of each bin of time they take. Drops are counted.
Json TimelineData::overview_json() const {
  const double bin_ps = std::max(1.0, real(end_ps()) / kBins);
  std::map<std::pair<std::string, std::string>, std::vector<double>> lanes;
  for (const platform::TimelineEvent& event : events_) {
    const std::string kind = name_of(event.kind);
    const std::string what = event.what;
    if (kind == "wait" || kind == "interrupt" || (kind == "frame" && what != "cycles")) continue;
    const bool has_side = kind == "capture" || kind == "drop";
    std::vector<double>& bins = lanes[{kind, has_side ? what : std::string()}];
    bins.resize(kBins);
    const auto bin_of = [&](std::uint64_t time_ps) {
      return std::min(kBins - 1, static_cast<std::size_t>(real(time_ps) / bin_ps));
    };
    if (kind == "drop") {
      bins[bin_of(event.begin_ps)] += 1;
      continue;
    }
    for (std::size_t bin = bin_of(event.begin_ps); bin <= bin_of(event.end_ps); ++bin) {
      const double from = std::max(real(event.begin_ps), bin_ps * static_cast<double>(bin));
      const double to = std::min(real(event.end_ps), bin_ps * static_cast<double>(bin + 1));
      bins[bin] += 100 * std::max(0.0, to - from) / bin_ps;
    }
  }
  Json json = {{"bins", kBins}, {"end_ps", end_ps()}, {"lanes", Json::array()}};
  for (const auto& [name, bins] : lanes) {
    Json amounts = Json::array();
    for (const double amount : bins) amounts.push_back(std::lround(amount));
    json["lanes"].push_back({{"kind", name.first}, {"class", name.second}, {"amounts", std::move(amounts)}});
  }
  return json;
}

// The sums of all waits, by who waits and why.
Json TimelineData::waits_json() const {
  std::map<std::pair<std::string, std::string>, std::uint64_t> sums;
  for (const platform::TimelineEvent& event : events_) {
    if (event.kind == platform::EventKind::kWait)
      sums[{event.what, event.why}] += event.end_ps - event.begin_ps;
  }
  Json json = Json::array();
  for (const auto& [name, sum_ps] : sums)
    json.push_back({{"class", name.first}, {"why", name.second}, {"ps", sum_ps}});
  return json;
}

// Of many frames: as many, at equal distances when ordered by their latency; the least and the greatest are
// among them.
Json TimelineData::latency_json() const {
  std::vector<const Latency*> order;
  for (const Latency& latency : latencies_) order.push_back(&latency);
  std::stable_sort(order.begin(), order.end(),
                   [](const Latency* a, const Latency* b) { return a->back() < b->back(); });
  const std::size_t rows = std::min(order.size(), kMostLatencies);
  const std::vector<std::string> names = names_of(stats::latency_csv_head());
  Json shown = Json::array();
  for (std::size_t row = 0; row < rows; ++row)
    shown.push_back(*order[rows < 2 ? row : row * (order.size() - 1) / (rows - 1)]);
  Json means = Json::object();
  for (std::size_t column = kFirstPart; column < names.size(); ++column) {
    double sum = 0;
    for (const Latency& latency : latencies_) sum += real(latency[column]);
    means[names[column]] = sum / real(std::max<std::size_t>(1, latencies_.size()));
  }
  return {{"names", names}, {"rows", std::move(shown)}, {"all", latencies_.size()}, {"means_ps", means}};
}

Json TimelineData::json() const {
  return {{"events", events_json()},
          {"overview", overview_json()},
          {"waits", waits_json()},
          {"latency", latency_json()}};
}

}  // namespace stereotlm::report
