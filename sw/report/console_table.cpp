#include "sw/report/console_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace stereotlm::report {
namespace {

constexpr std::size_t kNameColumns = 24;
constexpr double kBytesPerWord = 4;

std::string shortened(const std::string& name, std::size_t columns = kNameColumns) {
  return name.size() <= columns ? name : name.substr(0, columns - 3) + "...";
}

std::string rate_lines(const platform::Statistics& statistics) {
  std::uint64_t cycles = 0;
  for (const std::uint64_t of_frame : statistics.frame_cycles) cycles += of_frame;
  const double frames = static_cast<double>(std::max<std::size_t>(statistics.frame_cycles.size(), 1));
  return fmt::format("{:<12} {:>10.3f} frames/s   {:.0f} cycles a frame, {} frame{}\n", "core",
                     statistics.frames_per_second.core, static_cast<double>(cycles) / frames,
                     statistics.frames, statistics.frames == 1 ? "" : "s") +
         fmt::format("{:<12} {:>10.3f} frames/s   limited by {}\n", "bound", statistics.bound.core,
                     shortened(statistics.bound.core_limited_by, 48));
}

std::string bank_lines(const platform::Statistics& statistics, double clock_mhz) {
  std::size_t width = 12;
  for (const auto& bank : statistics.banks) width = std::max(width, shortened(bank.name).size());
  std::string text = fmt::format("{:<{}} {:>14} {:>14} {:>7} {:>9} {:>9}\n", "bank", width, "reads", "writes",
                                 "use %", "MB/s", "peak MB/s");
  for (const auto& bank : statistics.banks) {
    text += fmt::format("{:<{}} {:>14} {:>14} {:>7.2f} {:>9.2f} {:>9.2f}\n", shortened(bank.name), width,
                        bank.reads, bank.writes, 100 * bank.utilization, bank.megabytes_per_second,
                        kBytesPerWord * clock_mhz);
  }
  return text;
}

std::string stall_line(const platform::Statistics& statistics) {
  const auto worst = std::max_element(
      statistics.blame.begin(), statistics.blame.end(),
      [](const platform::BlameRow& a, const platform::BlameRow& b) { return a.cycles < b.cycles; });
  if (worst == statistics.blame.end()) return fmt::format("{:<12} none\n", "worst stall");
  const double share = statistics.cycles == 0 ? 0
                                              : 100 * static_cast<double>(worst->cycles) /
                                                    static_cast<double>(statistics.cycles);
  return fmt::format("{:<12} {} on {} lost {} cycles ({:.2f} %) to {}\n", "worst stall", worst->port,
                     shortened(worst->bank, 12), worst->cycles, share, worst->by);
}

std::string accuracy_line(const Accuracy& accuracy) {
  const auto number = [](const std::optional<double>& percent) {
    return percent ? fmt::format("{:.2f} %", *percent) : std::string("n/a");
  };
  return fmt::format("{:<12} off by more than 1: {}, by more than 2: {}, answered: {}\n", "accuracy",
                     number(accuracy.bad_1_percent), number(accuracy.bad_2_percent),
                     number(accuracy.answered_percent));
}

}  // namespace

std::string console_table(const platform::Statistics& statistics, double clock_mhz,
                          const std::optional<Accuracy>& accuracy) {
  return rate_lines(statistics) + bank_lines(statistics, clock_mhz) + stall_line(statistics) +
         (accuracy ? accuracy_line(*accuracy) : "");
}

}  // namespace stereotlm::report
