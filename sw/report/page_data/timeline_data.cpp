#include "sw/report/page_data/timeline_data.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <string>

#include "sw/report/page_data/packed_column.h"
#include "sw/report/timeline_csv.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

// Columns of timeline.csv and of latency.csv.
enum EventColumn : std::size_t { kKind, kClass, kFrame, kCameraFrame, kStart, kEnd, kWords, kPixels, kWhy };
enum LatencyColumn : std::size_t { kLatencyFrame, kLatencyCameraFrame, kCaptured, kFirstPart };

Json named(const std::string& name, const PackedColumn& column) {
  Json packed = {{"name", name}};
  packed.update(column.json());
  return packed;
}

// Times and words as double: many different integers are shortest as the bytes of real numbers, which are
// exact up to 2^53.
double real(std::uint64_t number) { return static_cast<double>(number); }

}  // namespace

TimelineData::TimelineData()
    : events_csv_("timeline.csv", timeline_csv_head()), latencies_csv_("latency.csv", latency_csv_head()) {}

std::size_t TimelineData::word(std::string_view text) {
  const auto known = std::find(words_.begin(), words_.end(), text);
  if (known != words_.end()) return static_cast<std::size_t>(known - words_.begin());
  words_.emplace_back(text);
  return words_.size() - 1;
}

void TimelineData::add_events(std::string_view text) {
  events_csv_.read(text, [this](const CsvLines::Cells& cells) {
    const auto number = [&](EventColumn column) { return events_csv_.number(cells[column]); };
    const auto number_if_any = [&](EventColumn column) {
      return cells[column].empty() ? std::int64_t{-1} : static_cast<std::int64_t>(number(column));
    };
    events_.push_back({word(cells[kKind]), word(cells[kClass]), word(cells[kWhy]), number_if_any(kFrame),
                       number_if_any(kCameraFrame), number(kStart), number(kEnd), number(kWords),
                       number(kPixels)});
  });
}

void TimelineData::add_latencies(std::string_view text) {
  latencies_csv_.read(text, [this](const CsvLines::Cells& cells) {
    Latency latency;
    for (std::size_t column = 0; column < latency.size(); ++column)
      latency[column] = latencies_csv_.number(cells[column]);
    latencies_.push_back(latency);
  });
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
    const auto at =
        std::lower_bound(events_.begin(), events_.end(), middle_ps,
                         [](const Event& event, std::uint64_t time_ps) { return event.end_ps < time_ps; });
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
  std::array<PackedColumn, kWhy + 1> columns;
  for (const Event& event : events_) {
    const bool is_shown = std::any_of(shown.begin(), shown.end(), [&event](const Period& period) {
      return event.end_ps >= period.first && event.begin_ps <= period.second;
    });
    if (!is_shown) continue;
    columns[kKind].add(words_[event.kind]);
    columns[kClass].add(words_[event.what]);
    columns[kFrame].add(event.frame);
    columns[kCameraFrame].add(event.camera_frame);
    columns[kStart].add(real(event.begin_ps));
    columns[kEnd].add(real(event.end_ps));
    columns[kWords].add(static_cast<std::int64_t>(event.words));
    columns[kPixels].add(static_cast<std::int64_t>(event.dropped_pixels));
    columns[kWhy].add(words_[event.why]);
  }
  constexpr std::array kNames = {"kind",   "class", "frame",          "camera_frame", "start_ps",
                                 "end_ps", "words", "dropped_pixels", "why"};
  Json json = {{"rows", columns[kKind].size()}, {"all", events_.size()}, {"columns", Json::array()}};
  for (std::size_t column = 0; column < columns.size(); ++column)
    json["columns"].push_back(named(kNames[column], columns[column]));
  json["periods_ps"] = Json::array();
  for (const auto& [begin, end] : shown) json["periods_ps"].push_back({begin, end});
  return json;
}

// Of captures, transfers and cycles of the core: how much of each bin of time they take. Drops are counted.
Json TimelineData::overview_json() const {
  const double bin_ps = std::max(1.0, real(end_ps()) / kBins);
  std::map<std::pair<std::string, std::string>, std::vector<double>> lanes;
  for (const Event& event : events_) {
    const std::string& kind = words_[event.kind];
    const std::string& what = words_[event.what];
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
    PackedColumn column;
    for (const double amount : bins) column.add(static_cast<std::int64_t>(std::lround(amount)));
    json["lanes"].push_back({{"kind", name.first}, {"class", name.second}, {"amounts", column.json()}});
  }
  return json;
}

// The sums of all waits, by who waits and why.
Json TimelineData::waits_json() const {
  std::map<std::pair<std::string, std::string>, std::uint64_t> sums;
  for (const Event& event : events_) {
    if (words_[event.kind] == "wait")
      sums[{words_[event.what], words_[event.why]}] += event.end_ps - event.begin_ps;
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
  std::array<PackedColumn, std::tuple_size_v<Latency>> columns;
  for (std::size_t row = 0; row < rows; ++row) {
    const Latency& latency = *order[rows < 2 ? row : row * (order.size() - 1) / (rows - 1)];
    for (std::size_t column = 0; column < latency.size(); ++column)
      columns[column].add(real(latency[column]));
  }
  std::istringstream head(latency_csv_head());
  Json packed = Json::array();
  Json means = Json::object();
  for (std::size_t column = 0; column < columns.size(); ++column) {
    std::string name;
    std::getline(head, name, column + 1 < columns.size() ? ',' : '\n');
    packed.push_back(named(name, columns[column]));
    if (column < kFirstPart) continue;
    double sum = 0;
    for (const Latency& latency : latencies_) sum += real(latency[column]);
    means[name] = sum / real(std::max<std::size_t>(1, latencies_.size()));
  }
  return {{"rows", rows}, {"all", latencies_.size()}, {"means_ps", means}, {"columns", std::move(packed)}};
}

Json TimelineData::json() const {
  return {{"events", events_json()},
          {"overview", overview_json()},
          {"waits", waits_json()},
          {"latency", latency_json()}};
}

}  // namespace stereotlm::report
