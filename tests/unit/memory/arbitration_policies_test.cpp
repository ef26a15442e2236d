#include "models/memory/arbitration_policies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/memory/ports.h"

namespace stereotlm::memory {

void PrintTo(const ArbitrationPolicy& policy, std::ostream* out) { *out << policy.name; }

namespace {

const PriorityList kList = {port::kRightLut, port::kResult,    port::kLeftLut,
                            port::kHost,     port::kLeftPixel, port::kRightPixel};

// The rules that each policy must keep in every order that it can reach (ArbitrationPolicy).
class EveryPolicy : public testing::TestWithParam<ArbitrationPolicy> {
 protected:
  EveryPolicy() {
    std::vector<PriorityList> found = {kList};
    orders_ = {kList};
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (PortMask requests = 0; requests <= kAll; ++requests) {
        for (PortMask winner = 0; winner <= requests; winner = winner == 0 ? 1 : winner << 1U) {
          if ((winner & ~requests) != 0) continue;
          const PriorityList order = after(found[i], requests, winner);
          if (orders_.insert(order).second) found.push_back(order);
        }
      }
    }
  }
  PriorityList after(PriorityList order, PortMask requests, PortMask granted) const {
    if (GetParam().advance != nullptr) GetParam().advance(kList, order, requests, granted);
    return order;
  }

  std::set<PriorityList> orders_;
};

TEST_P(EveryPolicy, OrdersAllPorts) {
  for (const PriorityList& order : orders_)
    ASSERT_TRUE(std::is_permutation(order.begin(), order.end(), kList.begin(), kList.end()));
}

TEST_P(EveryPolicy, TakesFurtherIdleCyclesForNothing) {
  for (const PriorityList& order : orders_) {
    const PriorityList idle = after(order, 0, 0);
    ASSERT_EQ(after(idle, 0, 0), idle);
  }
}

TEST_P(EveryPolicy, TakesFurtherUncontendedGrantsToAPortForIdleCycles) {
  for (const PriorityList& order : orders_) {
    for (const Port port : kList) {
      const PriorityList granted = after(order, mask_of(port), mask_of(port));
      ASSERT_EQ(after(granted, mask_of(port), mask_of(port)), after(granted, 0, 0));
    }
  }
}

TEST_P(EveryPolicy, ForgetsAsTheTableSays) {
  bool forgets = true;
  for (const PriorityList& order : orders_) {
    for (const Port port : kList) forgets = forgets && after(order, mask_of(port), mask_of(port)) == kList;
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
