#include "sw/trace/change_stream.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/file_size_limit.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::trace {
namespace {

class ChangeStreamTest : public ::testing::Test {
 protected:
  // Some 20 buffers.
  static constexpr std::uint32_t kChanges = 2'000'000;
  // Times beyond 32 bits.
  static std::uint64_t time_of(std::uint32_t change) { return (std::uint64_t{1} << 33U) + change / 2; }

  std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(scratch_.path()), {});
  }

  test::ScratchFolder scratch_;
  ChangeStream stream_{scratch_.path() / "file.vcd"};
};

TEST_F(ChangeStreamTest, GivesEachChangeBackWithItsTime) {
  for (std::uint32_t change = 0; change < kChanges; ++change)
    stream_.add(time_of(change), change % 100, change ^ 0x80000000);
  EXPECT_EQ(files(), 0);  // its file has no name
  stream_.rewind();
  for (std::uint32_t change = 0; change < kChanges; ++change, stream_.advance()) {
    ASSERT_FALSE(stream_.at_end());
    ASSERT_EQ(stream_.change().time_ps, time_of(change));
    ASSERT_EQ(stream_.change().signal, change % 100);
    ASSERT_EQ(stream_.change().value, change ^ 0x80000000);
  }
  EXPECT_TRUE(stream_.at_end());
}

TEST_F(ChangeStreamTest, AFewChangesTakeNoFileAndNoneAreNone) {
  const test::FileSizeLimit no_file(0);
  ChangeStream empty(scratch_.path() / "file.vcd");
  empty.rewind();
  EXPECT_TRUE(empty.at_end());
  stream_.add(0, 1, 2);
  stream_.rewind();
  EXPECT_EQ(stream_.change().signal, 1);
  stream_.advance();
  EXPECT_TRUE(stream_.at_end());
}

TEST_F(ChangeStreamTest, AFullDiskIsReportedWithTheNameOfTheFile) {
  const test::FileSizeLimit limit(1000);
  EXPECT_EQ(test::message_of([&] {
              for (std::uint32_t change = 0; change < kChanges; ++change) stream_.add(change, 0, change);
            }),
            (scratch_.path() / "file.vcd").string() + ": temporary file: File too large");
}

}  // namespace
}  // namespace stereotlm::trace
