#include "sw/runs/run_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "sw/files/json_text.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

RecordedOptions pair_of_pictures() {
  RecordedOptions options;
  options.program_version = "0.1.0";
  options.source = "preloaded";
  options.fidelity = "cycle";
  options.frames = 4;
  options.left = InputFile{"/in/left.png", "aa"};
  options.right = InputFile{"/in/right.png", "bb"};
  return options;
}

TEST(RunJson, NamesEveryOptionAndTheSumOfEveryInput) {
  RecordedOptions options = pair_of_pictures();
  options.truth = InputFile{"/in/truth.png", "cc"};
  options.truth_scale = 2.5;
  EXPECT_EQ(run_json(options),
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
}

RecordedOptions without_pictures() {
  RecordedOptions options = pair_of_pictures();
  options.left.reset();
  options.right.reset();
  return options;
}

// What stands behind the number of frames.
std::string pictures_in(const RecordedOptions& options) {
  const std::string text = run_json(options);
  const std::string before = "  \"frames\": 4,\n";
  return text.substr(text.find(before) + before.size());
}

TEST(RunJson, NamesEveryPictureOfASequence) {
  RecordedOptions options = without_pictures();
  options.sequence = InputFolder{"/in", {{"left_0.png", "aa"}, {"right_0.png", "bb"}}};
  options.save_frames = true;
  EXPECT_EQ(pictures_in(options), R"(  "sequence": {
    "path": "/in",
    "files": [
      {"name": "left_0.png", "sha256": "aa"},
      {"name": "right_0.png", "sha256": "bb"}
    ]
  },
  "save_frames": true
}
)");
}

TEST(RunJson, NamesVideosWithTheirLayout) {
  RecordedOptions options = without_pictures();
  options.video = {{"/in/l.avi", "aa"}, {"/in/r.avi", "bb"}};
  options.video_layout = "two";
  EXPECT_EQ(pictures_in(options), R"(  "video": [
    {"path": "/in/l.avi", "sha256": "aa"},
    {"path": "/in/r.avi", "sha256": "bb"}
  ],
  "video_layout": "two"
}
)");
}

TEST(RunJson, NamesTheSeedOfASyntheticScene) {
  RecordedOptions options = without_pictures();
  options.synthetic = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(pictures_in(options), "  \"synthetic\": 18446744073709551615\n}\n");
}

TEST(RunJson, LeavesOutOptionsThatWereNotGiven) {
  for (const char* key : {"truth", "sequence", "video", "synthetic", "save_frames"}) {
    EXPECT_THAT(run_json(pair_of_pictures()), Not(HasSubstr(key)));
  }
}

TEST(RunJson, RefusesPathsThatCannotBeFoundAgain) {
  RecordedOptions options = pair_of_pictures();
  options.left->path = "left.png";
  EXPECT_EQ(test::message_of([&] { run_json(options); }),
            "--left 'left.png': not an absolute path: run.json needs one");
  options = pair_of_pictures();
  options.right->path = "/in/\xFF.png";
  EXPECT_EQ(test::message_of([&] { run_json(options); }),
            "--right '/in/\xFF.png': a path that is not UTF-8: run.json cannot name it");
  options = pair_of_pictures();
  options.truth = InputFile{"truth.png", ""};
  EXPECT_EQ(test::message_of([&] { run_json(options); }),
            "--truth 'truth.png': not an absolute path: run.json needs one");
  options = without_pictures();
  options.sequence = InputFolder{"in", {}};
  EXPECT_EQ(test::message_of([&] { run_json(options); }),
            "--sequence 'in': not an absolute path: run.json needs one");
  options.sequence = InputFolder{"/in", {{"left_\xFF.png", ""}}};
  EXPECT_EQ(test::message_of([&] { run_json(options); }),
            "--sequence 'left_\xFF.png': a path that is not UTF-8: run.json cannot name it");
  options = without_pictures();
  options.video = {{"a.avi", ""}};
  EXPECT_EQ(test::message_of([&] { run_json(options); }),
            "--video 'a.avi': not an absolute path: run.json needs one");
}

}  // namespace
}  // namespace stereotlm::runs
