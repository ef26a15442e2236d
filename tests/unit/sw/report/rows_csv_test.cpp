#include "sw/report/rows_csv.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "sw/report/whole_file.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::report {
namespace {

constexpr const char* kHead =
    "frame,row,a_cycles,b_cycles,a_left_lut_stall_cycles,a_right_lut_stall_cycles,a_left_pixel_stall_cycles,"
    "a_right_pixel_stall_cycles,a_result_stall_cycles,b_left_lut_stall_cycles,b_right_lut_stall_cycles,"
    "b_left_pixel_stall_cycles,b_right_pixel_stall_cycles,b_result_stall_cycles\n";

TEST(RowsCsv, HasALineForEachFrameAndRow) {
  const test::ScratchFolder folder;
  const auto path = folder.path() / "rows.csv";
  RowsCsv csv(path);
  csv.add({{10, {1, 2, 3, 4, 5}}, {25, {1, 2, 3, 4, 6}}}, {{11, {}}, {26, {0, 7, 0, 0, 0}}});
  csv.add({{9, {}}, {18, {}}}, {{9, {}}, {18, {}}});
  EXPECT_FALSE(std::filesystem::exists(path));
  csv.commit();
  EXPECT_EQ(read_whole_file(path), std::string(kHead) +
                                       "0,0,10,11,1,2,3,4,5,0,0,0,0,0\n"
                                       "0,1,15,15,0,0,0,0,1,0,7,0,0,0\n"
                                       "1,0,9,9,0,0,0,0,0,0,0,0,0,0\n"
                                       "1,1,9,9,0,0,0,0,0,0,0,0,0,0\n");
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
}

TEST(RowsCsv, LeavesTheFileAsItWasWithoutCommit) {
  const test::ScratchFolder folder;
  const auto path = folder.path() / "rows.csv";
  test::write_file(path, "before");
  { const RowsCsv csv(path); }
  EXPECT_EQ(read_whole_file(path), "before");
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
}

TEST(RowsCsv, NamesAFileThatCannotBeWritten) {
  const test::ScratchFolder folder;
  const std::string missing = (folder.path() / "none" / "rows.csv").string();
  EXPECT_EQ(test::message_of([&] { const RowsCsv csv(missing); }),
            "'" + missing + "': cannot be written: No such file or directory");
  EXPECT_EQ(test::message_of([&] { const RowsCsv csv(folder.path()); }),
            "'" + folder.path().string() + "': is a folder");
}

TEST(RowsCsv, SaysThatTheDiskIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const test::ScratchFolder folder;
  const auto path = folder.path() / "rows.csv";
  std::filesystem::create_symlink("/dev/full", path.string() + ".part");
  RowsCsv csv(path);
  EXPECT_EQ(test::message_of([&] { csv.commit(); }), "'" + path.string() + "': cannot be written");
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_FALSE(std::filesystem::is_symlink(path.string() + ".part"));
}

}  // namespace
}  // namespace stereotlm::report
