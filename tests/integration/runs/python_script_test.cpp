#include "sw/process/python_script.h"

#include <gmock/gmock.h>

#include <stdexcept>
#include <string>

#include "tests/support/scratch_folder.h"

namespace stereotlm::runs {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class PythonScript : public testing::Test {
 protected:
  // That is not there.
  std::string path(const std::string& name) const { return (folder_.path() / "none" / name).string(); }

 private:
  test::ScratchFolder folder_;
};

TEST_F(PythonScript, SaysThatPythonIsMissing) {
  const std::string python = path("python3");
  EXPECT_THAT([&] { process::become_script("plot_all.py", {}, python); },
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("'" + python + "', which draws the figures: cannot be started: No such file")));
}

TEST_F(PythonScript, SaysThatTheScriptIsMissing) {
  EXPECT_THAT([] { process::become_script("plot_nothing.py", {}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/plots/plot_nothing.py': not found")));
}

TEST_F(PythonScript, SaysSoToWhoeverWaitsForItsEndToo) {
  const std::string python = path("python3");
  EXPECT_THAT([&] { process::run_script("plot_paper.py", {}, python); },
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("'" + python + "', which draws the figures: cannot be started: No such file")));
  EXPECT_THAT([] { process::run_script("plot_nothing.py", {}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/plots/plot_nothing.py': not found")));
}

TEST_F(PythonScript, TellsHowAScriptHasEnded) {
  const auto end = process::run_script("plot_paper.py", {"--out=" + path("out"), "--", path("in")});
  EXPECT_EQ(end.status, 1);
  EXPECT_THAT(end.errors, HasSubstr(path("in/table1.csv")));
}

}  // namespace
}  // namespace stereotlm::runs
