#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "tests/support/plain_clock.h"

// The capture board written again from contract section 3, one pixel and one word at a time. Shares no code
// with the models.
namespace stereotlm::test {

// How the bus dealt with one request.
struct PlainAnswer {
  std::uint64_t granted_ps = 0;
  std::vector<std::uint64_t> left_ps;  // of each word transferred
  std::uint64_t end_ps = 0;
  bool lost = false;
};

struct PlainCapture {
  using Word = std::pair<std::uint64_t, std::uint32_t>;  // address, value
  std::vector<std::uint64_t> asked_ps;
  std::vector<std::vector<Word>> bursts;  // as they begin
  std::uint64_t dropped_pixels = 0;
  std::optional<std::pair<int, int>> first_dropped;  // column, row
  std::uint64_t lost_words = 0;
  std::optional<std::uint64_t> end_ps;  // none: the answers did not suffice
};

struct PlainBoard {
  PlainCamera camera;
  int fifo_words = 0;
  int trigger_words = 0;
  std::uint64_t begin_ps = 0;  // of the frame
  std::uint64_t address = 0;
};

// One frame, row-major pixels, on a bus that gave these answers.
PlainCapture plain_capture(const PlainBoard& board, const std::vector<std::uint8_t>& pixels,
                           const std::vector<PlainAnswer>& answers);

}  // namespace stereotlm::test
