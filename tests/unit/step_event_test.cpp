#include "models/step_event.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace stereotlm {
namespace {

// Notes the times of its steps. A step may set the next one.
class Stepped : public sc_core::sc_module {
 public:
  explicit Stepped(const sc_core::sc_module_name& name) : sc_module(name) {
    SC_HAS_PROCESS(Stepped);
    SC_METHOD(step);
    sensitive << due;
    dont_initialize();
  }
  StepEvent due{"due"};
  std::vector<std::uint64_t> steps_ps;
  std::function<void()> then = [] {};

 private:
  void step() {
    due.taken();
    steps_ps.push_back(kernel_time::now_ps());
    then();
  }
};

class StepEventTest : public testing::Test {
 protected:
  std::vector<std::uint64_t> steps_to(std::uint64_t end_ps) {
    sc_core::sc_start(kernel_time::to_time(end_ps - kernel_time::now_ps()));
    return module.steps_ps;
  }
  Stepped module{"module"};
};

TEST_F(StepEventTest, ComesAtTheLastTimeThatWasSet) {
  module.due.set(20);
  module.due.set(10);
  module.due.set(30);
  EXPECT_EQ(steps_to(100), std::vector<std::uint64_t>{30});
  module.due.set(110);
  module.due.set(kNever);
  EXPECT_EQ(steps_to(200), std::vector<std::uint64_t>{30});
}

TEST_F(StepEventTest, ComesAgainAtATimeThatIsSetAnew) {
  module.then = [this] {
    if (module.steps_ps.size() == 1) module.due.set(30);
  };
  module.due.set(30);
  EXPECT_EQ(steps_to(100), (std::vector<std::uint64_t>{30, 30}));
}

}  // namespace
}  // namespace stereotlm
