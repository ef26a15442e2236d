#include "sw/report/diff_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "sw/stats/console_table.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

// Port, bank and cause of a wait.
using Wait = std::tuple<std::string, std::string, std::string>;

struct Rates {
  const char* kind;
  double a;
  double b;
  double uncertainty;  // of both
};

Rates rates_of(const Json& a, const Json& b) {
  for (const auto& [key, kind] : {std::pair("steady", "steady"), std::pair("system", "from power-up")}) {
    if (!a.contains(key) || !b.contains(key)) continue;
    const std::string uncertainty = std::string(key) + "_uncertainty";
    return {kind, a.at(key), b.at(key), a.value(uncertainty, 0.0) + b.value(uncertainty, 0.0)};
  }
  return {"core only", a.at("core"), b.at("core"), 0};
}

double cycles_a_frame(const Json& stats) {
  return static_cast<double>(cycles_of_frames(stats)) / stats.at("frames").get<double>();
}

std::map<Wait, double> waits_a_frame(const Json& stats) {
  std::map<Wait, double> waits;
  for (const Json& row : stats.at("blame"))
    waits[{row.at("port"), row.at("bank"), row.at("by")}] =
        row.at("cycles").get<double>() / stats.at("frames").get<double>();
  return waits;
}

// Why one run is faster. `b_is_faster`: by the rates, which need not be those of the core. A wait is named if its
// change is at least half of that of the cycles.
std::string cause(const JudgedRun& a, const JudgedRun& b, bool b_is_faster) {
  const JudgedRun& slower = b_is_faster ? a : b;
  const JudgedRun& faster = b_is_faster ? b : a;
  const double more = cycles_a_frame(slower.stats) - cycles_a_frame(faster.stats);
  if (cycles_a_frame(slower.stats) / slower.clock_mhz <= cycles_a_frame(faster.stats) / faster.clock_mhz)
    return fmt::format("the core is not faster in {}, and the difference arises around it",
                       b_is_faster ? "B" : "A");
  if (a.clock_mhz != b.clock_mhz)
    return fmt::format("the core runs at {} MHz in A and at {} MHz in B", a.clock_mhz, b.clock_mhz);
  const std::map<Wait, double> before = waits_a_frame(faster.stats);
  std::pair<Wait, double> largest = {{}, 0};
  for (const auto& [wait, cycles] : waits_a_frame(slower.stats)) {
    const auto found = before.find(wait);
    const double longer = cycles - (found == before.end() ? 0 : found->second);
    if (longer > largest.second) largest = {wait, longer};
  }
  if (largest.second >= more / 2) {
    const auto& [port, bank, by] = largest.first;
    return fmt::format("in {} {} waits {:.0f} cycles a frame more on {} for {}", b_is_faster ? "A" : "B",
                       port, largest.second, bank, stats::cause_text(by));
  }
  return fmt::format("a frame takes {:.0f} cycles in A, limited by {}, and {:.0f} in B, limited by {}",
                     cycles_a_frame(a.stats), stats::resource_text(a.stats.at("bound").at("core_limited_by")),
                     cycles_a_frame(b.stats),
                     stats::resource_text(b.stats.at("bound").at("core_limited_by")));
}

std::string pixels_text(const stats::PixelComparison* pixels) {
  if (pixels == nullptr || pixels->frames() == 0) return "the disparities are not compared";
  return pixels->first() ? "the disparities differ" : "the disparities are the same";
}

}  // namespace

std::uint64_t cycles_of_frames(const Json& stats) {
  const std::vector<std::uint64_t> frames = stats.at("frame_cycles");
  return std::accumulate(frames.begin(), frames.end(), std::uint64_t{0});
}

std::string diff_verdict(const JudgedRun& a, const JudgedRun& b, const stats::PixelComparison* pixels) {
  const Rates rates = rates_of(a.stats.at("frames_per_second"), b.stats.at("frames_per_second"));
  if (rates.a == rates.b) {
    return fmt::format("A and B are equally fast, {:.3f} frames/s, {}; {}.", rates.a, rates.kind,
                       pixels_text(pixels));
  }
  const bool b_is_faster = rates.b > rates.a;
  const std::string why = cause(a, b, b_is_faster) + "; " + pixels_text(pixels);
  const double gain = std::abs(rates.b - rates.a);
  constexpr double kShown = 0.0005;  // frames/s; less rounds to 0.000
  if (gain < kShown)
    return fmt::format("A and B are equally fast to 0.001 frames/s, {}: {}.", rates.kind, why);
  if (gain <= rates.uncertainty)
    return fmt::format("A and B are equally fast within the uncertainty of {:.3f} frames/s, {}: {}.",
                       rates.uncertainty, rates.kind, why);
  return fmt::format("{} is faster by {:.3f} frames/s ({:.2f} %), {}: {}.", b_is_faster ? "B" : "A", gain,
                     100 * gain / std::min(rates.a, rates.b), rates.kind, why);
}

}  // namespace stereotlm::report
