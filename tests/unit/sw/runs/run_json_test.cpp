#include "sw/runs/run_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

RecordedOptions pair_of_pictures() {
  RecordedOptions options;
  options.program_version = "0.1.0";
  options.source = "preloaded";
  options.fidelity = "cycle";
  options.frames = 4;
  options.left = {InputFile{"/in/left.png", "aa"}};
  options.right = {InputFile{"/in/right.png", "bb"}};
  return options;
}

RecordedOptions without_pictures() {
  RecordedOptions options = pair_of_pictures();
  options.left.clear();
  options.right.clear();
  return options;
}

constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();

// run.json, checked to be read back as it was written.
std::string text_of(const RecordedOptions& options) {
  const std::string text = run_json(options);
  EXPECT_EQ(run_json(parse_run_json(text)), text);
  return text;
}

TEST(RunJson, NamesEveryOptionAndTheSumOfEveryInput) {
  RecordedOptions options = pair_of_pictures();
  options.truth = InputFile{"/in/truth.png", "cc"};
  options.truth_scale = 2.5;
  EXPECT_EQ(text_of(options),
            R"({
  "schema": 1,
  "command": "run",
  "version": "0.1.0",
  "source": "preloaded",
  "fidelity": "cycle",
  "frames": 4,
  "left": {"path": "/in/left.png", "sha256": "aa"},
  "right": {"path": "/in/right.png", "sha256": "bb"},
  "truth": {"path": "/in/truth.png", "sha256": "cc"},
  "truth_scale": 2.5
}
)");
  options.calibration = InputCalibration{{"/c.yaml", "dd"}, {"/c_left.lut", "ee"}, {"/c_right.lut", "ff"}};
  options.verify = options.save_frames = options.record = options.no_record = true;
  options.frames = kLargest;
  text_of(options);
}

TEST(RunJson, IsReadAgainWithEachSourceOfPictures) {
  RecordedOptions options = without_pictures();
  options.sequence = InputFolder{"/in", {{"left_0.png", "aa"}, {"right_0.png", "bb"}}};
  text_of(options);
  options = pair_of_pictures();
  options.left.push_back({"/in/left2.png", "cc"});
  options.right.push_back({"/in/right2.png", "dd"});
  EXPECT_THAT(text_of(options), HasSubstr(R"(
  "left": [
    {"path": "/in/left.png", "sha256": "aa"},
    {"path": "/in/left2.png", "sha256": "cc"}
  ],)"));
  options = without_pictures();
  options.video = {{"/in/l.avi", "aa"}, {"/in/r.avi", "bb"}};
  options.video_layout = "two";
  text_of(options);
  options = without_pictures();
  options.synthetic = kLargest;
  EXPECT_THAT(text_of(options), HasSubstr("  \"synthetic\": 18446744073709551615\n}\n"));
  options = without_pictures();
  options.timing_only = true;
  text_of(options);
}

TEST(RunJson, RefusesRelativePathsAndPathsThatAreNotUtf8) {
  const std::string relative = ": not an absolute path: run.json needs one";
  const std::string not_utf8 = ": a path that is not UTF-8: run.json cannot name it";
  const auto expect_refusal = [](const std::string& message, RecordedOptions options, const auto& change) {
    change(options);
    EXPECT_EQ(test::message_of([&] { run_json(options); }), message);
  };
  const RecordedOptions pair = pair_of_pictures();
  expect_refusal("--left 'left.png'" + relative, pair, [](auto& to) { to.left[0].path = "left.png"; });
  expect_refusal("--right '/in/\xFF.png'" + not_utf8, pair,
                 [](auto& to) { to.right[0].path = "/in/\xFF.png"; });
  expect_refusal("--truth 'truth.png'" + relative, pair, [](auto& to) { to.truth = {"truth.png", ""}; });
  const RecordedOptions none = without_pictures();
  expect_refusal("--sequence 'in'" + relative, none, [](auto& to) { to.sequence = InputFolder{"in", {}}; });
  expect_refusal("--sequence 'left_\xFF.png'" + not_utf8, none, [](auto& to) {
    to.sequence = InputFolder{"/in", {{"left_\xFF.png", ""}}};
  });
  expect_refusal("--video 'a.avi'" + relative, none, [](auto& to) { to.video = {{"a.avi", ""}}; });
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

TEST(RunJsonReader, RefusesATextThatRunDoesNotWrite) {
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

TEST(RunJsonReader, RefusesOptionsThatNoRunCanHave) {
  EXPECT_EQ(message_of(changed("preloaded", "film")), "source = film: must be camera or preloaded");
  EXPECT_EQ(message_of(changed("cycle", "slow")), "fidelity = slow: must be fast or cycle");
  EXPECT_EQ(message_of(changed("\"frames\": 4", "\"frames\": 0")), "frames = 0: must be 1 or more");
  RecordedOptions options = pair_of_pictures();
  options.right.clear();
  EXPECT_EQ(message_of(run_json(options)), "left and right: must be as many");
  options = pair_of_pictures();
  options.synthetic = 1;
  EXPECT_EQ(message_of(run_json(options)), "2 sources of pictures: must be one");
  EXPECT_EQ(message_of(run_json(without_pictures())), "0 sources of pictures: must be one");
}

}  // namespace
}  // namespace stereotlm::runs
