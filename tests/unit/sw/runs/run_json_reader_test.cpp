#include "sw/runs/run_json_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

RecordedOptions pair_of_pictures() {
  RecordedOptions options;
  options.program_version = "0.1.0";
  options.source = "camera";
  options.fidelity = "fast";
  options.frames = 4;
  options.left = InputFile{"/in/left.png", "aa"};
  options.right = InputFile{"/in/right.png", "bb"};
  return options;
}

RecordedOptions without_pictures() {
  RecordedOptions options = pair_of_pictures();
  options.left.reset();
  options.right.reset();
  return options;
}

void expect_back(const RecordedOptions& options) {
  const std::string text = run_json(options);
  EXPECT_EQ(run_json(parse_run_json(text)), text);
}

TEST(RunJsonReader, ReadsBackWhatWasWritten) {
  RecordedOptions options = pair_of_pictures();
  const RecordedOptions read = parse_run_json(run_json(options));
  EXPECT_EQ(read.source, "camera");
  EXPECT_EQ(read.frames, 4U);
  EXPECT_EQ(read.right->path, "/in/right.png");
  EXPECT_EQ(read.right->sha256, "bb");
  EXPECT_FALSE(read.truth);
  options.truth = InputFile{"/in/truth.png", "cc"};
  options.truth_scale = 2.5;
  options.calibration = InputCalibration{{"/c.yaml", "dd"}, {"/c_left.lut", "ee"}, {"/c_right.lut", "ff"}};
  options.verify = true;
  options.save_frames = true;
  options.frames = std::numeric_limits<std::uint64_t>::max();
  expect_back(options);
}

TEST(RunJsonReader, ReadsBackEverySourceOfPictures) {
  RecordedOptions options = without_pictures();
  options.sequence = InputFolder{"/in", {{"left_0.png", "aa"}, {"right_0.png", "bb"}}};
  expect_back(options);
  EXPECT_EQ(parse_run_json(run_json(options)).sequence->files.back().path, "right_0.png");
  options = without_pictures();
  options.video = {{"/in/l.avi", "aa"}, {"/in/r.avi", "bb"}};
  options.video_layout = "two";
  expect_back(options);
  options = without_pictures();
  options.synthetic = std::numeric_limits<std::uint64_t>::max();
  expect_back(options);
  options = without_pictures();
  options.timing_only = true;
  expect_back(options);
}

std::string message_of(const std::string& text) {
  return test::message_of([&] { parse_run_json(text); });
}

// run.json of a pair, with one text in it replaced.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = run_json(pair_of_pictures());
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

TEST(RunJsonReader, RefusesWhatIsNotWrittenSo) {
  EXPECT_THAT(message_of(""), StartsWith("must be as run writes it: "));
  EXPECT_THAT(message_of("{}"), HasSubstr("version"));
  EXPECT_THAT(message_of("[]"), StartsWith("must be as run writes it: "));
  EXPECT_THAT(message_of(changed("4,", "\"4\",")), StartsWith("must be as run writes it: "));
  EXPECT_EQ(message_of(changed("\"schema\": 1", "\"schema\": 2")), "line 2: must be as run writes it");
  EXPECT_EQ(message_of(changed("\"command\": \"run\"", "\"command\": \"sweep\"")),
            "line 3: must be as run writes it");
  EXPECT_EQ(message_of(changed("\"frames\": 4,", "\"frames\": 4, \"more\": 1,")),
            "line 7: must be as run writes it");
  EXPECT_EQ(message_of(changed("\"frames\": 4", "\"frames\": -4")), "line 7: must be as run writes it");
  EXPECT_EQ(message_of(changed("/in/left.png", "left.png")),
            "--left 'left.png': not an absolute path: run.json needs one");
}

TEST(RunJsonReader, RefusesWhatNoRunIsToldSo) {
  EXPECT_EQ(message_of(changed("camera", "film")), "source = film: must be camera or preloaded");
  EXPECT_EQ(message_of(changed("fast", "slow")), "fidelity = slow: must be fast or cycle");
  EXPECT_EQ(message_of(changed("\"frames\": 4", "\"frames\": 0")), "frames = 0: must be 1 or more");
  RecordedOptions options = pair_of_pictures();
  options.right.reset();
  EXPECT_EQ(message_of(run_json(options)), "left and right: one is without the other");
  options = pair_of_pictures();
  options.synthetic = 1;
  EXPECT_EQ(message_of(run_json(options)), "2 sources of pictures: must be one");
  EXPECT_EQ(message_of(run_json(without_pictures())), "0 sources of pictures: must be one");
}

}  // namespace
}  // namespace stereotlm::runs
