// Random frames on a random bus against the literal board of plain_capture.h. A case is a process; a process
// has many boards, because each one is built before the simulation starts.
#include <random>
#include <string>

#include "tests/unit/capture/capture_bench.h"
#include "tests/unit/capture/plain_capture.h"

namespace stereotlm::capture {
namespace {

constexpr std::uint32_t kAddress = 0x4000;

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  int upto(int last) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(last + 1)); }
  bool one_in(int number) { return upto(number - 1) == 0; }

 private:
  std::mt19937 engine_;
};

struct RandomCapture {
  explicit RandomCapture(std::uint32_t seed) : dice(seed) {
    plain.camera.width = 4 * (1 + dice.upto(15));
    plain.camera.height = 1 + dice.upto(11);
    plain.camera.rate_hz = {1 + dice.upto(99'999), 100};
    if (plain.camera.rate_hz.numerator < 10) plain.camera.rate_hz.numerator = 10;
    plain.fifo_words = 1 + dice.upto(dice.one_in(2) ? 7 : 30);
    plain.trigger_words = 1 + dice.upto(plain.fifo_words - 1);
    plain.address = kAddress;
    const double rate_hz = static_cast<double>(plain.camera.rate_hz.numerator) / 100;
    const CameraConfig camera{plain.camera.width, plain.camera.height, rate_hz, CameraTrigger::kFreeRunning};
    // From a bus that is much faster than the pixels to one that is too slow for them.
    const double words_per_s = rate_hz * plain.camera.width * plain.camera.height / 4;
    clock_mhz = std::min(1000.0, std::max(1e-3, words_per_s * (1 + dice.upto(30)) / 1e6));
    side =
        std::make_unique<CaptureSide>("side" + std::to_string(seed) + "_", camera,
                                      CaptureBoardConfig{plain.fifo_words, plain.trigger_words}, clock_mhz);
    const int mood = dice.upto(3);  // how often others have the bus
    side->bus.plan = [this, mood](std::size_t) {
      test::BusTurn turn;
      if (dice.one_in(1 + mood)) turn.busy_clocks = static_cast<std::uint64_t>(dice.upto(mood * 20));
      turn.wait_clocks = static_cast<std::uint64_t>(dice.upto(4));
      if (dice.one_in(3)) {
        const int what = dice.upto(9);
        turn.limit = static_cast<std::size_t>(dice.upto(5));
        turn.cut = pci::BurstEnd::kDisconnect;
        if (what < 4) {
          turn.cut = pci::BurstEnd::kLatencyTimer;
          ++turn.limit;
        } else if (what == 9) {
          turn.cut = dice.one_in(2) ? pci::BurstEnd::kMasterAbort : pci::BurstEnd::kTargetError;
          turn.limit = 0;
        }
      }
      return turn;
    };
  }

  std::vector<test::PlainAnswer> answers() const {
    std::vector<test::PlainAnswer> out;
    for (const test::TestBus::Burst& burst : side->bus.bursts) {
      test::PlainAnswer answer;
      answer.granted_ps = burst.address_clock_ps;
      for (std::size_t i = 0; i < burst.result.words; ++i)
        answer.left_ps.push_back(side->bus.left_ps(burst, i));
      answer.end_ps = burst.end_ps;
      answer.lost =
          burst.result.end == pci::BurstEnd::kMasterAbort || burst.result.end == pci::BurstEnd::kTargetError;
      out.push_back(answer);
    }
    return out;
  }

  void expect_as_in(const test::PlainCapture& expected) const {
    EXPECT_EQ(side->bus.requests_ps, expected.asked_ps);
    ASSERT_EQ(side->bus.bursts.size(), expected.bursts.size());
    for (std::size_t i = 0; i < expected.bursts.size(); ++i) {
      std::vector<test::PlainCapture::Word> words;
      for (const std::uint32_t word : side->bus.bursts[i].words)
        words.emplace_back(side->bus.bursts[i].address + 4 * words.size(), word);
      EXPECT_EQ(words, expected.bursts[i]) << "burst " << i;
    }
    const auto& capture = side->board.last_capture();
    ASSERT_TRUE(capture);
    EXPECT_EQ(capture->end_ps, expected.end_ps);
    EXPECT_EQ(capture->dropped_pixels, expected.dropped_pixels);
    EXPECT_EQ(capture->lost_words, expected.lost_words);
    EXPECT_EQ(side->board.stats().words, side->bus.memory.size());
    EXPECT_EQ(side->board.stats().words * 4 + capture->lost_words * 4 + capture->dropped_pixels,
              side->source.picture(0).pixels.size());
  }

  Dice dice;
  test::PlainBoard plain;
  double clock_mhz = 0;
  std::unique_ptr<CaptureSide> side;
};

class CaptureRandom : public testing::TestWithParam<std::uint32_t> {};

TEST_P(CaptureRandom, IsTheLiteralBoard) {
  std::vector<std::unique_ptr<RandomCapture>> captures;
  for (std::uint32_t i = 0; i < 100; ++i) {
    captures.push_back(std::make_unique<RandomCapture>(GetParam() * 100 + i));
    captures.back()->side->arm(kAddress);
  }
  run_to(0);
  std::uint64_t now = 0;
  std::uint64_t drops = 0;
  std::uint64_t cuts = 0;
  std::uint64_t losses = 0;
  const auto all_done = [&] {
    return std::all_of(captures.begin(), captures.end(),
                       [](const auto& capture) { return capture->side->board.last_capture().has_value(); });
  };
  while (!all_done() && now < 200'000'000'000'000) run_to(now += 1'000'000'000'000);
  for (const auto& capture : captures) {
    SCOPED_TRACE(capture->side->board.name());
    const auto expected =
        test::plain_capture(capture->plain, capture->side->source.picture(0).pixels, capture->answers());
    capture->expect_as_in(expected);
    drops += expected.dropped_pixels > 0 ? 1U : 0U;
    losses += expected.lost_words > 0 ? 1U : 0U;
    for (const auto& burst : capture->side->bus.bursts)
      cuts +=
          burst.result.end == pci::BurstEnd::kLatencyTimer || burst.result.end == pci::BurstEnd::kDisconnect;
  }
  // The interesting cases do occur.
  EXPECT_GT(drops, 10U);
  EXPECT_LT(drops, 90U);
  EXPECT_GT(cuts, 100U);
  EXPECT_GT(losses, 10U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CaptureRandom, testing::Range(1U, 9U));

}  // namespace
}  // namespace stereotlm::capture
