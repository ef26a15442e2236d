// The FIFO by itself. The tests of the capture board check its requests, grants and drops against the bus.
#include "models/capture/capture_fifo.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stereotlm::capture {
namespace {

constexpr std::uint64_t kBegin = 1'000'000;

// Frames of 16 x 3 pixels, 4 words a line.
class CaptureFifoTest : public testing::Test {
 protected:
  void build(const CaptureBoardConfig& config) {
    fifo.emplace(config);
    fifo->begin_frame(timing, kBegin);
  }
  std::uint64_t pixel_ps(int column, int row) const { return kBegin + timing.pixel_ps(column, row); }
  std::uint64_t word_ps(int word, int row) const { return pixel_ps(4 * word + 3, row); }
  int granted(std::uint64_t time_ps) {
    fifo->advance(time_ps);
    fifo->grant(burst);
    int words = 0;
    for (const LineWords& line : burst) words += line.count;
    return words;
  }
  // All words of a burst leave at one time.
  void leave_at(std::uint64_t time_ps, int words) {
    fifo->leave(time_ps, words, [=](std::uint64_t now) { return now < time_ps ? 0 : words; });
  }

  CameraTiming timing{{16, 3, 29.97, CameraTrigger::kFreeRunning}};
  std::optional<CaptureFifo> fifo;
  std::vector<LineWords> burst;
};

TEST_F(CaptureFifoTest, RequestsTheBusAtItsTriggerOrAtTheEndOfTheLine) {
  for (int trigger = 1; trigger <= 5; ++trigger) {
    build({8, trigger});
    const int words = std::min(trigger, 4);
    const std::uint64_t request_ps = word_ps(words - 1, 0);
    for (const std::uint64_t now : {kBegin, request_ps - 1, request_ps}) {
      fifo->advance(now);
      EXPECT_EQ(fifo->next_ps(), request_ps) << trigger;
      EXPECT_FALSE(fifo->finishes_next());
    }
    EXPECT_EQ(granted(request_ps), words);
  }
}

TEST_F(CaptureFifoTest, RequestsTheBusAgainForWordsThatArriveAfterTheGrant) {
  struct Case {
    const char* what;
    CaptureBoardConfig config;
    std::uint64_t granted_ps;
    int granted;
    std::uint64_t end_ps;  // end of the burst
    int left;              // words that have left by then
    std::optional<std::uint64_t> next_ps;
  };
  const std::uint64_t line_end_ps = word_ps(3, 0);
  const Case cases[] = {
      {"the trigger is to come", {8, 2}, word_ps(0, 0), 1, word_ps(1, 0), 1, word_ps(2, 0)},
      {"the end of the line is to come", {8, 3}, word_ps(1, 0), 2, word_ps(2, 0), 2, line_end_ps},
      {"the trigger was reached meanwhile", {8, 2}, word_ps(0, 0), 1, word_ps(2, 0), 1, word_ps(2, 0)},
      {"a line ended meanwhile", {8, 2}, word_ps(2, 0), 3, line_end_ps + 10, 3, line_end_ps + 10},
      {"empty between lines", {8, 2}, line_end_ps, 4, line_end_ps + 10, 4, std::nullopt},
      {"the rest of the line is dropped", {2, 2}, word_ps(1, 0), 2, pixel_ps(9, 0), 2, std::nullopt},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    build(c.config);
    ASSERT_EQ(granted(c.granted_ps), c.granted);
    leave_at(c.end_ps, c.left);
    EXPECT_EQ(fifo->next_ps(), c.next_ps);
  }
}

TEST(CaptureFifo, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(CaptureFifo(CaptureBoardConfig{4, 5}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::capture
