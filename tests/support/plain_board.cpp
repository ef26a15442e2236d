#include "tests/support/plain_board.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stereotlm::test {

ReferenceJointTable plain_joint_table(const PlainCycleInput& input) {
  return reference_joint_table(input.width, plain_table(input, input.left_lut, input.left_table),
                               plain_table(input, input.right_lut, input.right_table));
}

std::vector<std::uint32_t> plain_table(const PlainCycleInput& input, const std::optional<PlainBuffer>& buffer,
                                       const std::optional<std::vector<std::uint32_t>>& entries) {
  if (!buffer) return {};
  if (entries) return *entries;
  std::vector<std::uint32_t> identity;
  for (int row = 0; row < input.height; ++row) {
    for (int column = 0; column < input.width; ++column) {
      identity.push_back(0x8000'0000U | static_cast<std::uint32_t>(row) << 16U |
                         static_cast<std::uint32_t>(column));
    }
  }
  return identity;
}

PlainBoard::PlainBoard(PlainEvents& events, const PlainBoardInput& input, std::function<void()> frame_ends)
    : events_(events),
      input_(input),
      frame_ends_(std::move(frame_ends)),
      clock_(input.clock_mhz),
      places_(plain_places(input.core)),
      banks_(input.core.banks.size()),
      core_(input.core) {
  const auto picture_pixels =
      static_cast<std::size_t>(input.core.width) * static_cast<std::size_t>(input.core.height);
  for (auto& words : banks_) words.resize(picture_pixels * 5);  // nine pictures and two tables at most
}

void PlainBoard::host_asks(const PlainWord& at, bool write, PlainTraffic traffic, std::uint32_t& word,
                           PlainTime from_ps, std::function<void(PlainTime, PlainTime)> granted) {
  if (host_) throw std::logic_error("plain board: a word of the host while one waits");
  host_ = HostWord{at, write, traffic, &word, from_ps, std::move(granted)};
  await_cycle();
}

void PlainBoard::start_frame() {
  if (core_.runs()) throw std::logic_error("plain board: a start strobe while the core runs");
  next_cycle_ = std::max(next_cycle_, clock_.first_edge(events_.now()));
  first_cycle_ = next_cycle_;
  const int frame = static_cast<int>(frame_cycles_.size());
  compute(frame);
  core_.start_frame(frame);
  await_cycle();
}

void PlainBoard::await_cycle() {
  std::uint64_t cycle = next_cycle_;
  if (!core_.runs()) {
    if (!host_) return;
    cycle = std::max(cycle, clock_.first_edge(host_->from_ps));
  }
  events_.at(clock_.edge(cycle), PlainPhase::kDecisions, [this, cycle] { run_cycle(cycle); });
}

void PlainBoard::run_cycle(std::uint64_t cycle) {
  if (cycle < next_cycle_) return;  // another event has run it
  std::optional<PlainHostRequest> request;
  if (host_ && host_->from_ps <= events_.now())
    request = PlainHostRequest{host_->at, host_->write, host_->traffic};
  const bool ran = core_.runs();
  if (!ran && !request) return;
  next_cycle_ = cycle + 1;
  const bool granted = core_.step(static_cast<std::int64_t>(cycle), request);
  if (ran && !core_.runs()) {
    const std::uint64_t end = cycle + 1 + static_cast<std::uint64_t>(input_.core.pipeline_latency_cycles);
    frame_cycles_.push_back(end - first_cycle_);
    events_.at(clock_.edge(end), PlainPhase::kEffects, frame_ends_);
  }
  if (granted) grant_host(cycle);
  await_cycle();
}

void PlainBoard::grant_host(std::uint64_t cycle) {
  const HostWord host = std::move(*host_);
  host_.reset();
  std::uint32_t& stored = word_at(host.at);
  (host.write ? stored : *host.word) = host.write ? *host.word : stored;
  const auto latency = static_cast<std::uint64_t>(
      plain_read_latency(input_.core.banks[static_cast<std::size_t>(host.at.bank)]));
  host.granted(clock_.edge(cycle), clock_.edge(cycle + latency));
}

// Computes the disparities as the frame begins: the program accesses none of its buffers before its end.
void PlainBoard::compute(int frame) {
  const PlainCycleInput& core = input_.core;
  const auto input_entry = static_cast<std::size_t>(frame) % core.left_image.size();
  const auto output_entry = static_cast<std::size_t>(frame) % core.disparity.size();
  ReferenceInput input;
  input.width = core.width;
  input.height = core.height;
  input.left = pixels_at(places_.left_image[input_entry]);
  input.right = pixels_at(places_.right_image[input_entry]);
  if (core.joint_tables) {
    input.left_table = reference_left_entries(core.width, joint_table());
    input.right_table = reference_right_entries(core.width, joint_table());
  } else {
    input.left_table = table_at(places_.left_lut);
    input.right_table = table_at(places_.right_lut);
  }
  input.filter = input_.filter;
  input.window = core.window;
  input.disparities = core.disparities;
  input.lr_tolerance = input_.lr_tolerance;
  input.cost = input_.cost;
  const std::vector<std::uint32_t> words = compute_reference(input).disparity_words;
  const int words_of_row = core.width / 4;
  for (int word = 0; word < words_of_row * core.height; ++word) {
    word_at(plain_word(places_.disparity[output_entry], word / words_of_row, word % words_of_row,
                       words_of_row)) = words[static_cast<std::size_t>(word)];
  }
}

std::uint32_t& PlainBoard::word_at(const PlainWord& at) {
  return banks_[static_cast<std::size_t>(at.bank)].at(at.word);
}

std::vector<std::uint32_t> PlainBoard::words_at(const PlainParts& parts, int words_of_row) {
  std::vector<std::uint32_t> words;
  for (int row = 0; row < input_.core.height; ++row) {
    for (int word = 0; word < words_of_row; ++word)
      words.push_back(word_at(plain_word(parts, row, word, words_of_row)));
  }
  return words;
}

std::vector<std::uint8_t> PlainBoard::pixels_at(const PlainParts& parts) {
  std::vector<std::uint8_t> pixels;
  for (const std::uint32_t word : words_at(parts, input_.core.width / 4)) {
    for (unsigned byte = 0; byte < 4; ++byte) pixels.push_back(static_cast<std::uint8_t>(word >> (8 * byte)));
  }
  return pixels;
}

std::optional<std::vector<std::uint32_t>> PlainBoard::table_at(const PlainParts& parts) {
  if (parts.empty()) return std::nullopt;
  return words_at(parts, input_.core.width);
}

ReferenceJointTable PlainBoard::joint_table() {
  const auto middle = [this](PlainMiddle which) { return middles_[static_cast<std::size_t>(which)]; };
  return {*table_at(places_.left_lut),
          {middle(PlainMiddle::kLeftX), middle(PlainMiddle::kLeftY)},
          {middle(PlainMiddle::kRightX), middle(PlainMiddle::kRightY)}};
}

PlainCycleResult PlainBoard::core_result() {
  PlainCycleResult result = core_.result(static_cast<std::int64_t>(clock_.first_edge(events_.now())));
  result.frame_cycles = frame_cycles_;
  return result;
}

}  // namespace stereotlm::test
