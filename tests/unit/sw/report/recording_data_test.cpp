#include "sw/report/page_data/recording_data.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/stats/record_csv.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t sum(const std::vector<std::uint64_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

TEST(RecordingData, MapsOfManyCausesHaveLargerTilesWithTheSameSums) {
  const platform::BoardConfig board = platform::load_board("fpl2003");
  for (const int causes : {1, 5, 12}) {
    RecordingData data(board, false);
    data.add("rows.csv", stats::rows_csv_head(board));
    data.add("conflicts.csv", stats::conflicts_csv_head() + ",,,,1000,left_lut,bank0,host capture,1000\n");
    std::uint64_t all = 0;
    for (int row = 0; row < 480; ++row) {
      for (int column = 0; column < 640; column += 4) {
        const int cycles = 1 + (7 * row + column) % 50;
        all += static_cast<std::uint64_t>(cycles);
        for (int cause = 0; cause < causes; ++cause)
          data.add("conflicts.csv",
                   fmt::format("{},{},{},{},99,left_lut,bank{},{},{}\n", row, row, column, column + 3,
                               cause / 2, cause % 2 == 0 ? "host capture" : "turnaround", cycles));
      }
    }
    const Json json = data.json();
    const Json& tiles = json["tiles"];
    const std::size_t size = tiles["columns"].get<std::size_t>() * tiles["rows"].get<std::size_t>();
    EXPECT_LE(size, RecordingData::kMostTiles);
    EXPECT_LE(size * static_cast<std::size_t>(causes), RecordingData::kMostValues);
    EXPECT_GT(
        4 * size * static_cast<std::size_t>(causes),
        std::min(static_cast<std::size_t>(causes) * RecordingData::kMostTiles, RecordingData::kMostValues));
    EXPECT_EQ(tiles["width"].get<int>() * tiles["columns"].get<int>(), 640);
    EXPECT_EQ(tiles["height"].get<int>() * tiles["rows"].get<int>(), 480);
    ASSERT_EQ(json["stalls"].size(), static_cast<std::size_t>(causes));
    EXPECT_EQ(json["stalls"][0]["tiles"].size(), size);
    EXPECT_EQ(sum(json["stalls"][0]["tiles"]), all);
    EXPECT_EQ(sum(json["stalls"][0]["rows"]), all + 1000);
  }
}

// A run of frames of 10 ms. A frame has 9 events; the slowest has a latency of 90 ms, the others of 30 ms.
class LongRun {
 public:
  LongRun(std::uint64_t frames, std::uint64_t slowest)
      : board_(platform::load_board("fpl2003")), data_(board_, true) {
    data_.add("timeline.csv", stats::timeline_csv_head());
    data_.add("latency.csv", stats::latency_csv_head());
    for (std::uint64_t frame = 0; frame < frames; ++frame) {
      const std::uint64_t begin = frame * kFrame;
      std::string lines;
      for (int i = 0; i < 8; ++i)
        lines += fmt::format("wait,core,{0},{0},{1},{2},0,0,camera\n", frame, begin, begin + 1000);
      lines += fmt::format("frame,cycles,{0},{0},{1},{2},0,0,\n", frame, begin, begin + kFrame / 2);
      data_.add("timeline.csv", lines);
      const std::uint64_t latency = (frame == slowest ? 9 : 3) * kFrame;
      data_.add("latency.csv", fmt::format("{0},{0},{1},{2},0,0,0,0,0,0,0,{2}\n", frame, begin, latency));
    }
  }
  Json json() const { return data_.json(); }

  static constexpr std::uint64_t kFrame = 10'000'000'000;  // ps

 private:
  platform::BoardConfig board_;
  RecordingData data_;
};

TEST(RecordingData, ALongRunHasThreePeriodsOfEventsAndAllSums) {
  const Json json = LongRun(5000, 3000).json();
  const Json& events = json["events"];
  EXPECT_EQ(events["all"], 45'000);
  EXPECT_GT(events["rows"].size(), 3900U);
  EXPECT_LT(events["rows"].size(), 4100U);
  const Json& periods = events["periods_ps"];
  ASSERT_EQ(periods.size(), 3U);
  EXPECT_EQ(periods[0][0], 0);
  const std::uint64_t slowest = 3000 * LongRun::kFrame;
  EXPECT_LT(periods[1][0], slowest);
  EXPECT_GT(periods[1][1], slowest + 9 * LongRun::kFrame);
  const auto middle = (periods[1][0].get<std::uint64_t>() + periods[1][1].get<std::uint64_t>()) / 2;
  EXPECT_NEAR(static_cast<double>(middle), slowest + 4.5 * LongRun::kFrame, LongRun::kFrame);
  EXPECT_EQ(periods[2][1], json["events"]["rows"].back()[5]);
  ASSERT_EQ(json["waits"].size(), 1U);
  EXPECT_EQ(json["waits"][0]["ps"], 5000 * 8 * 1000);
  EXPECT_LT(json.dump().size(), 500'000U);
}

TEST(RecordingData, ALongRunHasItsQuickestAndSlowestLatenciesAndTheMeanOfAll) {
  const Json latency = LongRun(5000, 3000).json()["latency"];
  const Json& rows = latency["rows"];
  ASSERT_EQ(rows.size(), 1000U);
  EXPECT_EQ(latency["all"], 5000);
  EXPECT_EQ(latency["names"].back(), "latency_ps");
  EXPECT_EQ(rows.front().back(), 3 * LongRun::kFrame);
  EXPECT_EQ(rows.back().back(), 9 * LongRun::kFrame);
  EXPECT_DOUBLE_EQ(latency["means_ps"]["latency_ps"], (3.0 + 6.0 / 5000) * LongRun::kFrame);
}

TEST(RecordingData, AShortRunHasAllEvents) {
  const Json events = LongRun(400, 300).json()["events"];
  EXPECT_EQ(events["rows"].size(), 3600U);
  EXPECT_EQ(events["periods_ps"].size(), 1U);
}

}  // namespace
}  // namespace stereotlm::report
