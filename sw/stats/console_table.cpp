#include "sw/stats/console_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "sw/files/text_forms.h"

namespace stereotlm::stats {
namespace {

constexpr std::size_t kNameColumns = 24;
constexpr double kBytesPerWord = 4;

std::string shortened(const std::string& name, std::size_t columns = kNameColumns) {
  return name.size() <= columns ? name : name.substr(0, columns - 3) + "...";
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string bound_line(const char* name, double bound, const std::string& limited_by,
                       const std::string& frames = "") {
  return fmt::format("{:<14} {:>8.3f} frames/s{}   limited by {}\n", name, bound, frames,
                     shortened(resource_text(limited_by), 48 - frames.size()));
}

std::string rate_lines(const platform::Statistics& statistics) {
  std::uint64_t cycles = 0;
  for (const std::uint64_t of_frame : statistics.frame_cycles) cycles += of_frame;
  const double frames = static_cast<double>(std::max<std::size_t>(statistics.frame_cycles.size(), 1));
  return fmt::format("{:<12} {:>10.3f} frames/s   {:.0f} cycles a frame, {} frame{}\n", "core",
                     statistics.frames_per_second.core, static_cast<double>(cycles) / frames,
                     statistics.frames, statistics.frames == 1 ? "" : "s") +
         bound_line("core bound", statistics.bound.core, statistics.bound.core_limited_by);
}

std::string computer_rate_lines(const platform::Statistics& statistics) {
  const platform::FramesPerSecond& rate = statistics.frames_per_second;
  if (!rate.system || !statistics.bound.system) return "";
  const std::uint64_t lost = platform::lost_pixels(statistics);
  std::string text;
  if (rate.steady) {
    text = fmt::format("{:<14} {:>8.3f} ± {:.3f} frames/s   over {} frames{}\n", "steady",
                       rate.steady->frames_per_second, rate.steady->uncertainty, rate.steady->frames,
                       rate_remark(rate.steady->frames_per_second, *statistics.bound.system, lost));
  }
  if (rate.proven && rate.proven->exact)
    text += fmt::format("{:<14} {:>8.3f} frames/s   exactly {} in {} camera frames\n", "long run",
                        *rate.proven->exact, *rate.proven->deliveries, *rate.proven->camera_frames);
  return text +
         fmt::format("{:<14} {:>8.3f} frames/s{}{}\n", "from power-up", *rate.system, rate_remark(0, 0, lost),
                     rate.steady ? "" : "; too few frames for a steady rate") +
         bound_line("steady bound", *statistics.bound.system, statistics.bound.system_limited_by,
                    whole_text(statistics));
}

std::string pci_lines(const platform::ComputerStatistics& computer, const platform::BoardConfig& board) {
  const double words_a_clock = board.pci.width_bits / 32.0;
  const double peak = words_a_clock * kBytesPerWord * board.pci.clock_mhz;
  std::size_t width = 12;
  for (const platform::PciMasterStatistics& master : computer.pci_masters)
    width = std::max(width, master.name.size());
  std::string text = fmt::format("{:<{}} {:>14} {:>14} {:>7} {:>9} {:>9} {:>12}\n", "pci master", width,
                                 "transactions", "words", "data %", "MB/s", "peak MB/s", "mean wait us");
  for (const platform::PciMasterStatistics& master : computer.pci_masters) {
    const double use = share(master.words, computer.pci_clocks) / words_a_clock;
    text += fmt::format("{:<{}} {:>14} {:>14} {:>7.2f} {:>9.2f} {:>9.2f} {:>12.3f}\n", master.name, width,
                        master.transactions, master.words, 100 * use, use * peak, peak,
                        share(master.wait_clocks, master.transactions) / board.pci.clock_mhz);
  }
  return text;
}

std::string computer_lines(const platform::ComputerStatistics& computer, const platform::BoardConfig& board) {
  std::string text = pci_lines(computer, board);
  text += fmt::format("{:<12} busy {:.2f} % of its clocks\n", "pci bus",
                      100 * share(computer.pci_busy_clocks, computer.pci_clocks));
  const std::uint64_t words = computer.posted_words + computer.dma_words;
  const double peak = kBytesPerWord * board.bridge.local_clock_mhz;
  text += fmt::format(
      "{:<12} busy {:.2f} % of its clocks, {:.2f} of {:.2f} MB/s: {} words posted, {} by DMA\n", "local bus",
      100 * share(computer.local_busy_clocks, computer.local_clocks),
      share(words, computer.local_clocks) * peak, peak, computer.posted_words, computer.dma_words);
  text += fmt::format("{:<12} {:>9} {:>9} {:>9}   {:>9} {:>9} {:>9} {:>15}\n", "camera", "frames", "captured",
                      "dropped:", "not armed", "busy", "partner", "dropped pixels");
  for (const platform::CameraStatistics& camera : computer.cameras) {
    text += fmt::format("{:<12} {:>9} {:>9} {:>9}   {:>9} {:>9} {:>9} {:>15}\n", camera.name, camera.frames,
                        camera.captured_frames, camera.dropped_frames, camera.dropped_not_armed,
                        camera.dropped_busy, camera.dropped_by_partner, camera.dropped_pixels);
  }
  const platform::Percentiles& latency = computer.capture_to_host_ms;
  return text +
         fmt::format(
             "{:<12} capture to host, ms: min {:.3f}, p50 {:.3f}, p95 {:.3f}, p99 {:.3f}, max {:.3f}\n",
             "latency", latency.min, latency.p50, latency.p95, latency.p99, latency.max);
}

std::string bank_lines(const platform::Statistics& statistics, double clock_mhz) {
  std::size_t width = 12;
  const auto name_of = [](const auto& bank) { return shortened(platform::bank_text(bank.name)); };
  for (const auto& bank : statistics.banks) width = std::max(width, name_of(bank).size());
  std::string text = fmt::format("{:<{}} {:>14} {:>14} {:>7} {:>9} {:>9} {:>8}\n", "bank", width, "reads",
                                 "writes", "busy %", "MB/s", "peak MB/s", "energy %");
  for (const auto& bank : statistics.banks) {
    text += fmt::format("{:<{}} {:>14} {:>14} {:>7.2f} {:>9.2f} {:>9.2f} {:>8}\n", name_of(bank), width,
                        bank.reads, bank.writes, 100 * bank.utilization, bank.megabytes_per_second,
                        bank.ports * kBytesPerWord * clock_mhz,
                        bank.energy ? fmt::format("{:.2f}", bank.energy->energy_percent) : "-");
  }
  return text;
}

std::string energy_lines(const platform::EnergyStatistics& energy) {
  std::vector<std::string> buffers;
  for (const platform::BufferStatistics& buffer : energy.buffers) {
    if (buffer.bytes > 0)
      buffers.push_back(fmt::format("{} {:.3g}", buffer.name, buffer.megabytes_per_frame));
  }
  return fmt::format("{:<12} {:>10.3f} mJ a frame   {:.1f} mW, {}\n", "energy", energy.memory_mj_per_frame,
                     energy.memory_mw, platform::kEnergyIsOf) +
         fmt::format("{:<12} {:>10.3f} MB a frame\n  {}\n", "traffic", energy.megabytes_per_frame,
                     fmt::join(buffers, ", "));
}

std::string wait_lines(const platform::Statistics& statistics,
                       const std::optional<double>& waitless_frames_per_second) {
  const auto longest = std::max_element(
      statistics.blame.begin(), statistics.blame.end(),
      [](const platform::BlameRow& a, const platform::BlameRow& b) { return a.cycles < b.cycles; });
  if (longest == statistics.blame.end()) return fmt::format("{:<12} none\n", "waits");
  std::string text = fmt::format("{:<12} {}{}: {} cycles ({:.2f} %)\n", "waits",
                                 statistics.blame.size() > 1 ? "mostly " : "",
                                 wait_text(longest->port, shortened(longest->bank, 11), longest->by),
                                 longest->cycles, 100 * share(longest->cycles, statistics.cycles));
  if (waitless_frames_per_second) {
    text += fmt::format(
        "{:<12} {:>10.3f} frames/s   of {:.3f}, which the core reaches without waits\n", "waits cost",
        files::without_minus_zero(*waitless_frames_per_second - statistics.frames_per_second.core, 3),
        *waitless_frames_per_second);
  }
  return text;
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

std::string ports_text(const std::vector<std::string>& ports) {
  std::string text;
  for (auto first = ports.begin(), next = first; first != ports.end(); first = next) {
    const std::string group = group_text(*first);
    std::vector<std::uint64_t> lanes;
    for (; next != ports.end() && group_text(*next) == group; ++next) {
      if (*next != group) lanes.push_back(std::stoull(next->substr(group.size() + 1)));
    }
    text += (text.empty() ? "" : ", ") + group;
    if (!lanes.empty()) text += '.' + files::ranges_text(lanes, ",");
  }
  return text;
}

std::string rate_remark(double rate, double bound, std::uint64_t lost_pixels) {
  if (lost_pixels > 0) return fmt::format(", with {} pixel{} lost", lost_pixels, lost_pixels == 1 ? "" : "s");
  return rate - bound >= kVisibleRate ? ", at its bound within the uncertainty" : "";
}

std::string lost_pixels_text(std::uint64_t pixels) {
  if (pixels == 0) return "";
  return fmt::format("captures lose {} pixel{}: pictures are torn, and disparities are wrong there", pixels,
                     pixels == 1 ? "" : "s");
}

std::string console_table(const platform::Statistics& statistics, const platform::BoardConfig& board,
                          const TableExtras& extras) {
  std::string text = rate_lines(statistics) + computer_rate_lines(statistics) +
                     bank_lines(statistics, board.fpga.clock_mhz) +
                     wait_lines(statistics, extras.waitless_frames_per_second) +
                     energy_lines(statistics.energy);
  if (statistics.computer) text += computer_lines(*statistics.computer, board);
  if (extras.answered_percent) {
    text += fmt::format("{:<12} in {:.2f} % of the pixels of the last frame\n", "disparities",
                        *extras.answered_percent);
  }
  if (extras.accuracy) text += accuracy_line(*extras.accuracy);
  return text;
}

}  // namespace stereotlm::stats
