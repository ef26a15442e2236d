#include "sw/runs/progress.h"

#include <gtest/gtest.h>

#include <thread>

namespace stereotlm::runs {
namespace {

TEST(ProgressText, CountsAFrameInProgressByItsCycles) {
  EXPECT_EQ(progress_text({4, 1, 2'000'000, 2'500'000, 1'000'000}, 0.5),
            "1.25/4 frames   31.2 %   5.00 M cycles/s   2.50 frames/s   0:01 left");
  // The first frame is expected to take the cycles of its bound.
  EXPECT_EQ(progress_text({2, 0, 0, 250'000, 1'000'000}, 1),
            "0.25/2 frames   12.5 %   0.25 M cycles/s   0.25 frames/s   0:07 left");
  // A frame that takes longer is never shown as finished.
  EXPECT_EQ(progress_text({1, 0, 0, 3'000'000, 1'000'000}, 1).substr(0, 22), "1.00/1 frames   99.9 %");
  EXPECT_EQ(progress_text({2, 2, 2'000'000, 2'000'016, 1'000'000}, 1),
            "2.00/2 frames   100.0 %   2.00 M cycles/s   2.00 frames/s   0:00 left");
}

TEST(ProgressText, WritesLongTimes) {
  const auto left = [](std::uint64_t frames) {
    const std::string text = progress_text({frames, 1, 1'000'000, 1'000'000, 1}, 1);
    return text.substr(text.rfind("   ") + 3);
  };
  EXPECT_EQ(left(3600), "59:59 left");
  EXPECT_EQ(left(3601), "1:00:00 left");
  EXPECT_EQ(left(360'001), "100:00:00 left");
  EXPECT_EQ(left(18'446'744'073'709'551'615U), "years left");
}

TEST(ProgressText, OfEqualPiecesLeavesOutThoseThatWereDoneBefore) {
  EXPECT_EQ(progress_text(8, 20, "points", 5, 6), "8/20 points, 0:30 left");
}

TEST(ProgressLine, WritesNotesWithoutATerminalAndAnnouncesWhatTakesLongerThan5Seconds) {
  for (const std::uint64_t seconds : {2U, 100U}) {
    testing::internal::CaptureStderr();
    ProgressLine progress("boards are made", "sdram", std::chrono::milliseconds(300));
    for (int time = 0; time < 14; ++time) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      progress.show(1, seconds, [](double) { return "1 made"; });
    }
    const std::string shown = testing::internal::GetCapturedStderr();
    EXPECT_EQ(shown.rfind("stereotlm: note: 1 made\n", 0), 0U);
    EXPECT_EQ(shown.find("made, cycle by cycle because of sdram: 1 made\n") < shown.size(), seconds > 5);
  }
}

}  // namespace
}  // namespace stereotlm::runs
