#include "sw/report/rows_csv.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <string>

#include "sw/files/whole_file.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::report {
namespace {

constexpr const char* kHead =
    "frame,row,a_cycles,b_cycles,a_left_lut_stall_cycles,a_right_lut_stall_cycles,a_left_pixel_stall_cycles,"
    "a_right_pixel_stall_cycles,a_result_stall_cycles,b_left_lut_stall_cycles,b_right_lut_stall_cycles,"
    "b_left_pixel_stall_cycles,b_right_pixel_stall_cycles,b_result_stall_cycles\n";

std::ptrdiff_t files_in(const test::ScratchFolder& folder) {
  return std::distance(std::filesystem::directory_iterator(folder.path()), {});
}

TEST(RowsCsv, HasALineForEachFrameAndRow) {
  const test::ScratchFolder folder;
  const auto path = folder.path() / "rows.csv";
  RowsCsv csv(path);
  csv.add({{10, {1, 2, 3, 4, 5}}, {25, {1, 2, 3, 4, 6}}}, {{11, {}}, {26, {0, 7, 0, 0, 0}}});
  csv.add({{9, {}}, {18, {}}}, {{9, {}}, {18, {}}});
  EXPECT_FALSE(std::filesystem::exists(path));
  csv.commit();
  EXPECT_EQ(files::read_whole_file(path), std::string(kHead) +
                                              "0,0,10,11,1,2,3,4,5,0,0,0,0,0\n"
                                              "0,1,15,15,0,0,0,0,1,0,7,0,0,0\n"
                                              "1,0,9,9,0,0,0,0,0,0,0,0,0,0\n"
                                              "1,1,9,9,0,0,0,0,0,0,0,0,0,0\n");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(RowsCsv, NamesTheFileThatCannotBeWritten) {
  const test::ScratchFolder folder;
  const auto path = folder.path() / "rows.csv";
  const std::string refusal = "'" + path.string() + "': cannot be written: ";
  {
    const std::string full = refusal + "File too large";
    const test::FileSizeLimit limit(1000);
    RowsCsv csv(path);
    csv.add(fpga::RowProfile(100), fpga::RowProfile(100));
    EXPECT_EQ(test::message_of([&] { csv.commit(); }), full);
  }
  EXPECT_EQ(files_in(folder), 0);
  {
    RowsCsv csv(path);
    std::filesystem::create_directory(path);
    EXPECT_EQ(test::message_of([&] { csv.commit(); }), "'" + path.string() + "': is no file");
  }
  EXPECT_EQ(files_in(folder), 1);
}

}  // namespace
}  // namespace stereotlm::report
