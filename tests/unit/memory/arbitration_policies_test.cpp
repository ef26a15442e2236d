#include "models/memory/arbitration_policies.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/memory/ports.h"

namespace stereotlm::memory {

void PrintTo(const ArbitrationPolicy& policy, std::ostream* out) { *out << policy.name; }

namespace {

using State = ArbitrationPolicy::State;

const PriorityList kList = {port::kRightLut, port::kResult,    port::kLeftLut,
                            port::kHost,     port::kLeftPixel, port::kRightPixel};

// The rules that each policy must keep in every state that it can reach (ArbitrationPolicy).
class EveryPolicy : public testing::TestWithParam<ArbitrationPolicy> {
 protected:
  EveryPolicy() {
    std::vector<State> found = {0};
    states_ = {0};
    const auto add = [&](State state) {
      if (states_.insert(state).second) found.push_back(state);
    };
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (unsigned requests = 0; requests <= kAll; ++requests) {
        const State state = found[i];
        const auto mask = static_cast<PortMask>(requests);
        add(policy_->next(kList, state, mask, 0));
        if (mask != 0) add(policy_->next(kList, state, mask, mask_of(policy_->winner(kList, state, mask))));
      }
    }
  }

  const ArbitrationPolicy* policy_ = &GetParam();
  std::set<State> states_;
};

TEST_P(EveryPolicy, LetsOneOfTheRequestsWin) {
  for (const State state : states_) {
    for (unsigned requests = 1; requests <= kAll; ++requests)
      ASSERT_NE(requests & mask_of(policy_->winner(kList, state, static_cast<PortMask>(requests))), 0U)
          << state;
  }
}

TEST_P(EveryPolicy, TakesFurtherUncontendedGrantsToAPortForIdleCycles) {
  for (const State state : states_) {
    for (const Port port : kList) {
      const PortMask mask = mask_of(port);
      const State granted = policy_->next(kList, state, mask, mask);
      ASSERT_EQ(policy_->next(kList, granted, mask, mask), policy_->next(kList, granted, 0, 0)) << state;
    }
  }
}

TEST_P(EveryPolicy, ForgetsAsTheTableSays) {
  bool forgets = true;
  for (const State state : states_) {
    for (const Port port : kList)
      forgets = forgets && policy_->next(kList, state, mask_of(port), mask_of(port)) == 0;
  }
  EXPECT_EQ(forgets, GetParam().forgets);
}

INSTANTIATE_TEST_SUITE_P(ArbitrationPolicies, EveryPolicy, testing::ValuesIn(arbitration_policies()),
                         [](const auto& suite) { return std::string(suite.param.name); });

TEST(ArbitrationPolicies, AreFoundByTheirNames) {
  for (const ArbitrationPolicy& policy : arbitration_policies())
    EXPECT_EQ(find_arbitration_policy(policy.name), &policy);
  EXPECT_EQ(find_arbitration_policy("lottery"), nullptr);
}

}  // namespace
}  // namespace stereotlm::memory
