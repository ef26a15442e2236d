#include "sw/runs/limiter_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "sw/stats/wait_text.h"

namespace stereotlm::runs {
namespace {

using Limiter = Explanation::Limiter;

const std::string kHost = fpga::kPorts[fpga::kHostPort].name;
constexpr double kVisibleLoss = 0.01;     // of the cycles
constexpr double kVisiblePercent = 0.05;  // of the time of a frame
constexpr double kLeastHeadroom = 10;     // of a bus in percent; with less it is named beside what waits

struct Reason {
  const char* why;      // of the time line
  const char* limiter;  // whom the core waits for
  const char* text;
};
constexpr std::array<Reason, 6> kReasons = {
    Reason{"upload", "the upload of the tables", "the tables"},
    Reason{"camera", "the captures", "a camera frame to begin"},
    Reason{"capture", "the captures", "the end of a capture, which begins only with a camera frame"},
    Reason{"copy", "the copies from host memory", "the end of a copy from host memory"},
    Reason{"output_buffer", "the read-back", "a result to be read back"},
    Reason{"host", "the driver", "register accesses"}};

const Reason& reason_of(const std::string& why) {
  for (const Reason& reason : kReasons) {
    if (reason.why == why) return reason;
  }
  throw std::logic_error(why + ": not a reason for which the core waits");
}

double percent_of_cycles(Explanation& explanation, std::int64_t cycles) {
  return 100 * static_cast<double>(cycles) / static_cast<double>(explanation.figures().integer("cycles"));
}

// "left_lut waits there for left_pixel in 33.14 % of the cycles"
std::string wait_of(Explanation& explanation, const explore::StoredBlame& wait) {
  return fmt::format("{} waits there for {} in {:.2f} % of the cycles", wait.port, stats::cause_text(wait.by),
                     percent_of_cycles(explanation, wait.cycles));
}

// The PCI bus or the local bus, where it has little headroom.
std::string busy_bus_text(Explanation& explanation) {
  std::string text;
  for (const Explanation::Resource& resource : explanation.resources()) {
    if ((resource.name == "pci" || resource.name == "bridge") && resource.headroom_percent < kLeastHeadroom)
      text += fmt::format("; {} is busy in {:.1f} % of its clocks", stats::resource_words(resource.name),
                          resource.busy_percent);
  }
  return text;
}

std::string bound_text(Explanation& explanation) {
  const explore::StoredRow& row = explanation.figures();
  const std::string bound = explanation.camera() ? "bound.system" : "bound.core";
  const std::string owner = row.text(bound + "_limited_by");
  const std::string text =
      fmt::format("{}, at the bound of {:.3f} frames/s", stats::resource_words(owner), row.real(bound));
  const auto wait = longest_wait(explanation, owner);
  return wait ? text + "; " + wait_of(explanation, *wait) : text;
}

std::string lost_pixels_text(Explanation& explanation) {
  const explore::StoredRow& row = explanation.figures();
  const std::int64_t lost =
      row.integer("cameras.left.dropped_pixels") + row.integer("cameras.right.dropped_pixels");
  const std::string text =
      fmt::format(": captures lose {} pixels while {} frames are delivered, so pictures are torn", lost,
                  explanation.frames());
  for (const explore::StoredBlame& wait : explanation.blames()) {
    if (wait.port == kHost && percent_of_cycles(explanation, wait.cycles) > 100 * kVisibleLoss)
      return wait.bank + text + "; " + wait_of(explanation, wait);
  }
  const std::vector<Explanation::Resource> all = explanation.resources();
  const auto busy_of = [&all](const char* name) {
    return std::find_if(all.begin(), all.end(), [name](const auto& each) { return each.name == name; })
        ->busy_percent;
  };
  const char* const bus = busy_of("pci") >= busy_of("bridge") ? "pci" : "bridge";
  const std::int64_t of_load = row.integer("pci.masters.load.transactions");
  std::int64_t all_transactions = of_load;
  for (const char* const master : {"host", "left_capture", "right_capture", "bridge"})
    all_transactions += row.integer(fmt::format("pci.masters.{}.transactions", master));
  return fmt::format(
      "{}{}; it is busy in {:.1f} % of its clocks{}", stats::resource_words(bus), text, busy_of(bus),
      of_load == 0
          ? ""
          : fmt::format(", and pci.load makes {} of its {} transactions", of_load, all_transactions));
}

std::string waits_text(Explanation& explanation) {
  const std::string cost = fmt::format("all waits cost {:.2f} % of the time", explanation.budget().waits);
  const auto wait = longest_wait(explanation);
  return wait ? fmt::format("waits at {}: {}; {}", wait->bank, wait_of(explanation, *wait), cost)
              : "waits for banks: " + cost;
}

std::string queues_text(Explanation& explanation) {
  const double percent = result_queue_percent(explanation);
  if (percent > 0) {
    return fmt::format(
        "the result queue, which is too short: in {:.2f} % of the cycles the matcher waits for a place in it "
        "(fpga.result_fifo_words)",
        percent);
  }
  return fmt::format("the queues of the core and the latencies of its banks, which cost {:.2f} % of the time",
                     explanation.budget().queues);
}

std::string core_waits_text(Explanation& explanation) {
  double sum = 0;
  std::vector<std::pair<double, std::string>> shares;
  for (const auto& [why, share] : explanation.budget().core_waits) {
    sum += share;
    shares.emplace_back(share, why);
  }
  std::sort(shares.rbegin(), shares.rend());
  const bool is_one = shares.size() == 1 || shares[1].first < kVisiblePercent;
  std::string text =
      fmt::format("{}: the core waits {:.2f} % of the time", reason_of(shares.front().second).limiter,
                  is_one ? shares.front().first : sum);
  if (is_one) text += fmt::format(" for {}", reason_of(shares.front().second).text);
  const char* separator = ", ";
  for (const auto& [share, why] : shares) {
    if (is_one || share < kVisiblePercent) break;
    text += fmt::format("{}{:.2f} % for {}", separator, share, reason_of(why).text);
    separator = " and ";
  }
  return text + busy_bus_text(explanation);
}

}  // namespace

std::optional<explore::StoredBlame> longest_wait(Explanation& explanation, const std::string& resource) {
  for (const explore::StoredBlame& wait : explanation.blames()) {
    if (wait.port != kHost && (resource.empty() || platform::resource_of_bank(wait.bank) == resource))
      return wait;
  }
  return std::nullopt;
}

std::string limiter_text(Explanation& explanation) {
  switch (explanation.limiter()) {
    case Limiter::kLostPixels:
      return lost_pixels_text(explanation);
    case Limiter::kBound:
      return bound_text(explanation);
    case Limiter::kWaits:
      return waits_text(explanation);
    case Limiter::kQueues:
      return queues_text(explanation);
    case Limiter::kCoreWaits:
      return core_waits_text(explanation);
  }
  return "";
}

std::string budget_text(Explanation& explanation) {
  const Explanation::Budget& budget = explanation.budget();
  std::string text = fmt::format("{:.2f} % the matcher and the ports", budget.bound);
  if (budget.queues >= kVisiblePercent) text += fmt::format(", {:.2f} % queues and latencies", budget.queues);
  if (budget.waits >= kVisiblePercent) text += fmt::format(", {:.2f} % waits for banks", budget.waits);
  for (const auto& [why, share] : budget.core_waits) {
    if (share >= kVisiblePercent)
      text += fmt::format(", {:.2f} % the core waits for {}", share, reason_of(why).text);
  }
  return text;
}

double result_queue_percent(Explanation& explanation) {
  const explore::StoredRow& row = explanation.figures();
  const double cycles = static_cast<double>(row.integer("cycles"));
  const double lost = cycles * (1 - row.real("frames_per_second.core") / row.real("bound.core"));
  std::int64_t stalled = 0;
  std::int64_t blocked = 0;
  for (const fpga::CorePort& port : fpga::kPorts) {
    const std::string name = std::string("ports.") + port.name;
    stalled += row.integer(name + ".stall_cycles");
    blocked = std::max(blocked, row.integer(name + ".blocked_cycles"));
  }
  const bool is_too_short = row.text("bound.core_limited_by") == "matcher" && lost > kVisibleLoss * cycles &&
                            stalled == 0 && static_cast<double>(blocked) > lost / 2;
  return is_too_short ? 100 * lost / cycles : 0;
}

}  // namespace stereotlm::runs
