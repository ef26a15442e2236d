// Random frames on a random bus, against the literal board of plain_capture_board.h. Each case is a process
// that simulates many boards at once.
#include <random>
#include <string>

#include "tests/support/plain_capture_board.h"
#include "tests/support/plain_events.h"
#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  int upto(int last) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(last + 1)); }
  bool one_in(int number) { return upto(number - 1) == 0; }

 private:
  std::mt19937 engine_;
};

// Repeats the grants, words and ends of bursts of a test bus.
class BusAsBefore : public test::PlainBus {
 public:
  BusAsBefore(test::PlainEvents& events, const test::TestBus& before) : events_(events), before_(before) {}
  std::size_t add(test::PlainMaster& master) override {
    master_ = &master;
    return 0;
  }
  void request(std::size_t /*master*/) override {
    requests_ps.push_back(events_.now());
    if (bursts.size() == before_.bursts.size()) return;
    events_.at(before_.bursts[bursts.size()].address_clock_ps, test::PlainPhase::kDecisions,
               [this] { begin(before_.bursts[bursts.size()]); });
  }
  std::vector<std::uint64_t> requests_ps;
  std::vector<test::PlainBurst> bursts;

 private:
  void begin(const test::TestBus::Burst& before) {
    bursts.push_back(master_->burst());
    for (std::size_t word = 0; word < before.result.words; ++word) {
      events_.at(before_.left_ps(before, word), test::PlainPhase::kEffects, [this] { master_->word_gone(); });
    }
    events_.at(before.end_ps, test::PlainPhase::kEffects, [this, &before] {
      const bool lost = before.result.end == pci::BurstEnd::kMasterAbort ||
                        before.result.end == pci::BurstEnd::kTargetError;
      if (lost) master_->lost();
      master_->ended({});
    });
  }

  test::PlainEvents& events_;
  const test::TestBus& before_;
  test::PlainMaster* master_ = nullptr;
};

struct RandomCapture {
  explicit RandomCapture(std::uint32_t seed) : dice(seed) {
    plain.camera.width = 4 * (1 + dice.upto(15));
    plain.camera.height = 1 + dice.upto(11);
    plain.camera.rate_hz = {1 + dice.upto(99'999), 100};
    if (plain.camera.rate_hz.numerator < 10) plain.camera.rate_hz.numerator = 10;
    plain.fifo_words = 1 + dice.upto(dice.one_in(2) ? 7 : 30);
    plain.fifo_trigger_words = 1 + dice.upto(plain.fifo_words - 1);
    const double rate_hz = static_cast<double>(plain.camera.rate_hz.numerator) / 100;
    const CameraConfig camera{plain.camera.width, plain.camera.height, rate_hz, CameraTrigger::kFreeRunning};
    // From a bus that is much faster than the pixels to one that is too slow for them.
    const double words_per_s = rate_hz * plain.camera.width * plain.camera.height / 4;
    clock_mhz = std::min(1000.0, std::max(1e-3, words_per_s * (1 + dice.upto(30)) / 1e6));
    side = std::make_unique<CaptureSide>("side" + std::to_string(seed) + "_", camera,
                                         CaptureBoardConfig{plain.fifo_words, plain.fifo_trigger_words},
                                         clock_mhz);
    const int mood = dice.upto(3);  // how often other masters have the bus
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

  // The literal board captures the same frame on the same bus.
  void expect_as_literal_board() const {
    test::PlainEvents events;
    BusAsBefore bus(events, side->bus);
    test::PlainCaptureBoard literal(events, bus, plain);
    literal.arm({nullptr, 0, kAddress / 4});
    literal.frame_begins(0, true, side->source.picture(0).pixels);
    while (!literal.done()) events.run_next();
    EXPECT_EQ(side->bus.requests_ps, bus.requests_ps);
    ASSERT_EQ(side->bus.bursts.size(), bus.bursts.size());
    for (std::size_t i = 0; i < bus.bursts.size(); ++i) {
      EXPECT_EQ(side->bus.bursts[i].address, 4 * bus.bursts[i].word) << "burst " << i;
      EXPECT_EQ(side->bus.bursts[i].words, bus.bursts[i].words) << "burst " << i;
    }
    const auto& capture = side->board.last_capture();
    ASSERT_TRUE(capture);
    EXPECT_EQ(capture->end_ps, literal.done_ps());
    EXPECT_EQ(capture->dropped_pixels, literal.stats().dropped_pixels);
    EXPECT_EQ(capture->lost_words, literal.stats().lost_words);
    EXPECT_EQ(side->board.stats().words, side->bus.memory.size());
    EXPECT_EQ(side->board.stats().words * 4 + capture->lost_words * 4 + capture->dropped_pixels,
              side->source.picture(0).pixels.size());
  }

  Dice dice;
  test::PlainCaptureConfig plain;
  double clock_mhz = 0;
  std::unique_ptr<CaptureSide> side;
};

class CaptureRandom : public testing::TestWithParam<std::uint32_t> {};

TEST_P(CaptureRandom, CapturesLikeTheLiteralBoard) {
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
    capture->expect_as_literal_board();
    drops += capture->side->board.last_capture()->dropped_pixels > 0 ? 1U : 0U;
    losses += capture->side->board.last_capture()->lost_words > 0 ? 1U : 0U;
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
