#include "sw/runs/rerun.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <deque>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/binder.h"
#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/runs/run_results.h"
#include "sw/stats/accuracy.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::runs {
namespace {

constexpr char kFrame = 'f';
constexpr char kFigures = 's';
constexpr char kRecord = 'r';

// put() and take() write and read the message in which the child sends a frame to the parent: kind, number,
// rows, pixels. Values are copied as bytes, because both processes run the same program.
template <typename Value>
void put(std::string& message, const Value& value) {
  message.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename Value>
void take(const char*& bytes, Value& value) {
  std::memcpy(&value, bytes, sizeof value);
  bytes += sizeof value;
}

std::string message_of(const Result& result, const fpga::RowProfile& rows) {
  std::string message(1, kFrame);
  put(message, result.number);
  for (const fpga::RowEnd& row : rows) put(message, row);
  const auto& pixels = result.disparity.pixels;
  return message.append(pixels.begin(), pixels.end());
}

Rerun::Frame frame_of(const std::string& message, const RecordedRun& run) {
  Rerun::Frame frame;
  const char* bytes = message.data() + 1;
  take(bytes, frame.number);
  frame.rows.resize(static_cast<std::size_t>(run.board.image.height));
  for (fpga::RowEnd& row : frame.rows) take(bytes, row);
  if (run.options.timing_only) return frame;
  frame.disparity = kernels::GrayImage(run.board.image.width, run.board.image.height);
  std::memcpy(frame.disparity.pixels.data(), bytes, frame.disparity.pixels.size());
  return frame;
}

void run_again(const RecordedRun& run, bool record, const process::Child::Tell& tell) {
  process::Problems problems;
  RunInput input = open_again(run, problems);
  if (!problems.empty()) throw std::runtime_error("cannot be run any more: " + problems.in_one_line());
  input.fast = true;
  input.record = record;
  BlankPairs blank(input.board);
  host::FrameSource& pairs = input.timing_only ? static_cast<host::FrameSource&>(blank) : *input.pairs;
  Binder binder;
  const auto simulation = make_simulation(input.board, input.tables, pairs, input.mode(), binder);
  simulation->core().record_rows();
  Records records(input, [&tell](const std::string& name, const std::string& text) {
    tell(kRecord + name + '\n' + text);
  });
  std::deque<fpga::RowProfile> rows;  // rows of frames whose results are not delivered yet
  while (!simulation->finished()) {
    const std::vector<Result> results = simulation->advance();
    for (fpga::RowProfile& frame : simulation->core().take_rows()) rows.push_back(std::move(frame));
    if (!results.empty()) records.add(*simulation);  // next() returns soon after
    for (const Result& result : results) {
      tell(message_of(result, rows.front()));
      rows.pop_front();
    }
  }
  records.finish(*simulation);
  tell(kFigures + figures_of(simulation->statistics(), simulation->last(), input));
}

constexpr std::chrono::milliseconds kBetweenPolls{100};

}  // namespace

std::string figures_of(platform::Statistics statistics, const Result& last, const RunInput& input) {
  statistics.fidelity = input.described.fidelity;
  std::optional<stats::Accuracy> accuracy;
  if (input.truth) accuracy = stats::accuracy(last.disparity, *input.truth);
  return stats::stats_json(statistics, accuracy);
}

void check_repeated(const RecordedRun& run, const std::string& stats_json) {
  if (stats_json == run.stats_json) return;
  const auto differences = stats::stats_differences(run.stats_json, stats_json, "recorded", "again");
  std::string text = "repeated, it has other figures: " + differences.front();
  if (differences.size() > 1) text += fmt::format(", and {} more", differences.size() - 1);
  if (run.options.program_version != process::kVersion) text += "; " + version_note(run.options);
  throw std::runtime_error(text);
}

Rerun::Rerun(const RecordedRun& run, Record record)
    : run_(run),
      record_(std::move(record)),
      child_(std::make_unique<process::Child>(
          [&run, records = record_ != nullptr](const process::Child::Tell& tell) {
            run_again(run, records, tell);
          })) {}

std::optional<Rerun::Frame> Rerun::next() {
  try {
    std::optional<std::string> message = child_->next();
    while (message && message->front() == kRecord) {
      const std::size_t end_of_name = message->find('\n');
      record_(message->substr(1, end_of_name - 1), message->substr(end_of_name + 1));
      message = child_->next();
    }
    if (!message) throw std::runtime_error("has ended without figures");
    if (message->front() == kFrame) return frame_of(*message, run_);
    check_repeated(run_, message->substr(1));
    return std::nullopt;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", name_of(run_), error.what()));
  }
}

DiffLimits::DiffLimits(const RecordedRun& a, const RecordedRun& b) {
  const platform::ImageConfig& size_a = a.board.image;
  const platform::ImageConfig& size_b = b.board.image;
  if (size_a.width != size_b.width || size_a.height != size_b.height) {
    rows = pixels = fmt::format("images of {}x{} in A, of {}x{} in B", size_a.width, size_a.height,
                                size_b.width, size_b.height);
  } else if (a.options.timing_only || b.options.timing_only) {
    const bool both = a.options.timing_only && b.options.timing_only;
    pixels = fmt::format("there are none in {}", both ? "both" : a.options.timing_only ? "A" : "B");
  }
}

FrameAlignment::FrameAlignment(const RecordedRun& a, const RecordedRun& b, const DiffLimits& limits,
                               stats::RowsCsv* csv, Rerun::Record record_a, Rerun::Record record_b)
    : limits_(limits),
      csv_(csv),
      frames_(std::max(a.options.frames, b.options.frames)),
      a_(a, std::move(record_a)),
      b_(b, std::move(record_b)) {}

bool FrameAlignment::run() {
  bool goes_on = read(a_) && read(b_);
  // Advances the run with the lower camera frame, or both runs if these are equal, so that neither run passes
  // a frame that the other one still needs.
  while (goes_on && (a_.ahead || b_.ahead)) {
    const bool takes_a = a_.ahead && (!b_.ahead || a_.ahead->number <= b_.ahead->number);
    const bool takes_b = b_.ahead && (!a_.ahead || b_.ahead->number <= a_.ahead->number);
    if (takes_a && takes_b && limits_.pixels.empty()) {
      pixels_.add(a_.ahead->number, a_.ahead->disparity, b_.ahead->disparity);
      last_common_ = {a_.ahead->number, std::move(a_.ahead->disparity), std::move(b_.ahead->disparity)};
    }
    goes_on = (!takes_a || advance(a_, b_)) && (!takes_b || advance(b_, a_));
    compare_rows();
  }
  progress_.erase();
  return goes_on;
}

// Reads the next frame of a run. Polls for interrupts while it waits, and returns false after one.
bool FrameAlignment::read(Side& side) {
  do {
    if (process::interrupted()) return false;
    progress_.show([this](double) { return fmt::format("{}/{} frames compared", rows_.frames(), frames_); });
  } while (!side.rerun.has_news(kBetweenPolls));
  side.ahead = side.rerun.next();
  return true;
}

bool FrameAlignment::advance(Side& side, const Side& other) {
  const bool has_partner = other.ahead || !other.rows.empty();
  if (limits_.rows.empty() && has_partner) side.rows.push_back(std::move(side.ahead->rows));
  return read(side);
}

void FrameAlignment::compare_rows() {
  while (!a_.rows.empty() && !b_.rows.empty()) {
    rows_.add(a_.rows.front(), b_.rows.front());
    if (csv_ != nullptr) csv_->add(a_.rows.front(), b_.rows.front());
    a_.rows.pop_front();
    b_.rows.pop_front();
  }
}

}  // namespace stereotlm::runs
