#include <gmock/gmock.h>

#include <stdexcept>
#include <string>

#include "sw/process/command.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class PythonScript : public testing::Test {
 protected:
  // A path that does not exist.
  std::string path(const std::string& name) const { return (folder_.path() / "none" / name).string(); }

 private:
  test::ScratchFolder folder_;
};

TEST_F(PythonScript, ReportsThatPythonOrTheScriptIsMissing) {
  const std::string python = path("python3");
  const auto missing_python = ThrowsMessage<std::runtime_error>(
      HasSubstr("'" + python + "', which draws the figures: cannot be started: No such file"));
  EXPECT_THAT([&] { process::run_script("figures.py", {}, python); }, missing_python);
  const auto missing_script = ThrowsMessage<std::runtime_error>(HasSubstr("/plots/nothing.py': not found"));
  EXPECT_THAT([] { process::run_script("nothing.py", {}); }, missing_script);
}

TEST_F(PythonScript, ReturnsTheStatusAndTheErrorsOfAScript) {
  const auto end = process::run_script("figures.py", {"--out", path("out"), "--", path("in.db")});
  EXPECT_EQ(end.status, 2);
  EXPECT_THAT(end.errors, HasSubstr(path("in.db") + ": cannot be opened"));
}

}  // namespace
}  // namespace stereotlm::runs
