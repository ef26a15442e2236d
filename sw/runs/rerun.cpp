#include "sw/runs/rerun.h"

#include <fmt/format.h>

#include <cstring>
#include <deque>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/binder.h"
#include "sw/process/installation.h"
#include "sw/runs/run_mode.h"
#include "sw/runs/run_results.h"
#include "sw/stats/accuracy.h"
#include "sw/stats/stats_differences.h"
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
  const auto simulation = make_simulation(input.board, input.tables, pairs, run_mode(input), binder);
  simulation->record_rows();
  Records records(input, [&tell](const std::string& name, const std::string& text) {
    tell(kRecord + name + '\n' + text);
  });
  std::deque<fpga::RowProfile> rows;  // rows of frames whose results are not delivered yet
  while (!simulation->finished()) {
    const std::vector<Result> results = simulation->advance();
    for (fpga::RowProfile& frame : simulation->take_rows()) rows.push_back(std::move(frame));
    if (!results.empty()) records.add(*simulation);  // next() returns soon after
    for (const Result& result : results) {
      tell(message_of(result, rows.front()));
      rows.pop_front();
    }
  }
  records.finish(*simulation);
  tell(kFigures + figures_of(simulation->statistics(), simulation->last(), input));
}

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

}  // namespace stereotlm::runs
