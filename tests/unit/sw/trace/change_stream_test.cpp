#include "sw/trace/change_stream.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/file_size_limit.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::trace {
namespace {

constexpr std::uint32_t kChanges = 100'000;  // several buffers

TEST(ChangeStream, GivesEachChangeBackAndLeavesNoFile) {
  const test::ScratchFolder scratch;
  ChangeStream stream(scratch.path() / "file.vcd");
  for (std::uint32_t change = 0; change < kChanges; ++change)
    stream.add((std::uint64_t{1} << 33U) + change / 2, change % 100, change ^ 0x80000000);
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
  stream.rewind();
  for (std::uint32_t change = 0; change < kChanges; ++change, stream.advance()) {
    ASSERT_TRUE(stream.change());
    ASSERT_EQ(stream.change()->time_ps, (std::uint64_t{1} << 33U) + change / 2);
    ASSERT_EQ(stream.change()->signal, change % 100);
    ASSERT_EQ(stream.change()->value, change ^ 0x80000000);
  }
  EXPECT_FALSE(stream.change());
}

TEST(ChangeStream, ReportsAFullDiskWithTheNameOfTheFile) {
  const test::ScratchFolder scratch;
  ChangeStream stream(scratch.path() / "file.vcd");
  const test::FileSizeLimit limit(1000);
  EXPECT_EQ(test::message_of([&] {
              for (std::uint32_t change = 0; change < kChanges; ++change) stream.add(change, 0, change);
            }),
            (scratch.path() / "file.vcd").string() + ": temporary file: File too large");
}

}  // namespace
}  // namespace stereotlm::trace
