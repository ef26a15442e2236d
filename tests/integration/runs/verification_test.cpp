// What `--verify` reports if the repeated run differs. The results of the first run are made up here.
#include "sw/runs/verification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "platform/config/board_area.h"
#include "platform/config/board_yaml.h"
#include "platform/config/tables.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class VerificationTest : public testing::Test {
 protected:
  VerificationTest() {
    input.board =
        platform::load_board("fpl2003", {"image.width=16", "image.height=8", "matcher.disparities=4"});
    input.tables = platform::identity_tables(input.board);
    input.camera = false;
    input.timing_only = true;
    input.frames = 2;
  }
  // Verifies a run with these made-up results. Returns what fails, one line each.
  std::string failed_of(const std::vector<Result>& results, const platform::Statistics& statistics) {
    Verification verification(input);
    for (const Result& result : results) verification.add(result);
    const auto differences = verification.compare(statistics);
    std::string text;
    for (const std::string& line : differences.value()) text += line + '\n';
    return text;
  }

  RunInput input;
};

TEST_F(VerificationTest, NamesTheFramesAndFiguresThatDiffer) {
  platform::Statistics statistics;
  statistics.frames = 2;
  statistics.area = platform::area_of(input.board);  // known without a run
  const std::string said = failed_of({{0, {}, 123}, {1, {}, 456}}, statistics);
  EXPECT_THAT(said,
              ContainsRegex("the fidelities differ: frame 0: fast: camera frame 0, done at 123 ps; cycle: "
                            "camera frame 0, done at [0-9]+ ps"));
  EXPECT_THAT(said, HasSubstr("the fidelities differ: frame 1: fast: camera frame 1, done at 456 ps;"));
  EXPECT_THAT(
      said, ContainsRegex("the fidelities differ: stats.json: /banks/0/[a-z_]+: fast absent, cycle [0-9]+"));
  EXPECT_THAT(said, ContainsRegex("the fidelities differ: [0-9]+ more lines"));
  EXPECT_THAT(said, Not(HasSubstr("/fidelity")));
  EXPECT_THAT(said, Not(HasSubstr("/area")));
}

TEST_F(VerificationTest, NamesThePicturesThatCannotBeReadAnyMoreAndWhy) {
  const test::ScratchFolder empty;
  const std::string left = empty.path() / "left.png";
  const std::string right = empty.path() / "right.png";
  input.described.left = {InputFile{left, ""}};
  input.described.right = {InputFile{right, ""}};
  EXPECT_EQ(failed_of({{0, {}, 123}}, {}),
            "--verify: the run at fidelity cycle: the pictures cannot be read any more: --left '" + left +
                "': no such file; --right '" + right + "': no such file\n");
}

}  // namespace
}  // namespace stereotlm::runs
