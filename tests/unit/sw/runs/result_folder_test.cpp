// The files of a result. What holds for all output folders: tests/unit/sw/files.
#include <gtest/gtest.h>

#include <iterator>
#include <stdexcept>

#include "sw/runs/run_results.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;

class ResultFolderTest : public ::testing::Test {
 protected:
  test::ScratchFolder scratch_;
  fs::path out_ = scratch_.path() / "out";
};

TEST_F(ResultFolderTest, ReplacesEveryFileThatARunWrites) {
  for (const char* name :
       {"disparity.png", "disparity.pfm", "disparity_color.png", "depth.ply", "depth.png", "depth_color.png",
        "stats.json", "config.yaml", "run.json", "timeline.csv", "latency.csv", "rows.csv", "conflicts.csv",
        "frames/000000.png", "frames/1234567.png"}) {
    test::write_file(out_ / name, "old");
  }
  files::OutputFolder folder(out_, result_content());
  folder.add("run.json", "new");
  folder.commit();
  EXPECT_EQ(std::distance(fs::directory_iterator(out_), {}), 1);
}

TEST_F(ResultFolderTest, TakesOnlyFilesThatARunWrites) {
  files::OutputFolder folder(out_, result_content());
  for (const char* name : {"notes.txt", "frames/00000.png", "frames/0.png", "frames/000000.jpg",
                           "frames/a00000.png", "frames/000000.png.png", "000000.png"})
    EXPECT_THROW(folder.add(name, "x"), std::invalid_argument) << name;
}

}  // namespace
}  // namespace stereotlm::runs
