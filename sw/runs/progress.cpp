#include "sw/runs/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sw/process/client.h"
#include "sw/process/streams.h"

namespace stereotlm::runs {
namespace {

constexpr std::chrono::milliseconds kBetweenDrawings{200};
constexpr double kLongSeconds = 5;  // work that will take longer is announced after 1 s

std::size_t terminal_columns() {
  constexpr std::size_t kUsual = 80;
  winsize size = {};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsual;
}

// "0:08", "1:02:03", or "years" for more than 30 years.
std::string time_text(double seconds) {
  constexpr double kLongest = 1e9;
  if (!(seconds < kLongest)) return "years";
  const auto whole = static_cast<std::uint64_t>(std::llround(seconds));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

std::string progress_text(const RunState& state, double seconds) {
  const auto frames = static_cast<double>(state.frames);
  const auto done = static_cast<double>(state.frames_done);
  const double frame_cycles = state.frames_done > 0 ? static_cast<double>(state.cycles_of_done) / done
                                                    : static_cast<double>(state.least_frame_cycles);
  // Limited, because the running frame may be longer than earlier ones.
  const double part =
      std::min(0.999, static_cast<double>(state.cycles - state.cycles_of_done) / frame_cycles);
  const double position = state.frames_done == state.frames ? frames : done + part;
  const double rate = static_cast<double>(state.cycles) / seconds;
  return fmt::format("{:.2f}/{} frames   {:.1f} %   {:.2f} M cycles/s   {:.2f} frames/s   {} left", position,
                     state.frames, 100 * position / frames, rate / 1e6, rate / frame_cycles,
                     time_text((frames - position) * frame_cycles / rate));
}

std::string progress_text(std::uint64_t done, std::uint64_t of, const std::string& pieces, double seconds,
                          std::uint64_t before) {
  const std::string text = fmt::format("{}/{} {}", done, of, pieces);
  if (done == before) return text;
  return text + fmt::format(", {} left", time_text(seconds * static_cast<double>(of - done) /
                                                   static_cast<double>(done - before)));
}

ProgressLine::ProgressLine(const std::string& work, const std::string& stepped,
                           std::chrono::milliseconds between_notes)
    : work_(stepped.empty() ? work : work + ", cycle by cycle because of " + stepped),
      between_notes_(between_notes),
      start_(std::chrono::steady_clock::now()),
      next_(start_ + kBetweenDrawings),
      next_note_(start_ + between_notes) {}

void ProgressLine::show(std::uint64_t done, std::uint64_t of,
                        const std::function<std::string(double seconds)>& line) {
  const Time now = std::chrono::steady_clock::now();
  if (now < next_ || process::leaves_out_notes()) return;
  next_ = now + kBetweenDrawings;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double whole = done == 0 ? seconds : seconds * static_cast<double>(of) / static_cast<double>(done);
  const bool is_redrawn = process::client != nullptr || isatty(STDERR_FILENO) != 0;
  const bool is_announced = !work_.empty() && seconds > kLongSeconds / 5 && whole > kLongSeconds;
  if (!is_announced && !is_redrawn && now < next_note_) return;
  std::string text = line(seconds);
  if (is_announced || !is_redrawn) {
    erase();
    process::say("note", is_announced ? work_ + ": " + text : text);
    if (is_announced) work_.clear();
    next_note_ = now + between_notes_;
    return;
  }
  if (process::client != nullptr) return process::client->progress(done, of, text);
  text.resize(std::min(text.size(), terminal_columns() - 1));  // a wrapped line cannot be overwritten
  const std::size_t columns = text.size();
  if (columns < columns_drawn_) text.append(columns_drawn_ - columns, ' ');
  columns_drawn_ = columns;
  std::fprintf(stderr, "\r%s", text.c_str());
  std::fflush(stderr);
}

void ProgressLine::show_time() {
  show(0, 0, [](double seconds) { return time_text(seconds) + " so far"; });
}

void ProgressLine::erase() {
  if (columns_drawn_ == 0) return;
  std::fprintf(stderr, "\r%*s\r", static_cast<int>(columns_drawn_), "");
  columns_drawn_ = 0;
  std::fflush(stderr);
}

}  // namespace stereotlm::runs
