#include "models/memory/arbitration_policies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

PriorityList after(const ArbitrationPolicy& policy, PriorityList order, PortMask requests, PortMask granted) {
  if (policy.advance != nullptr) policy.advance(kList, order, requests, granted);
  return order;
}

std::string text_of(const PriorityList& order) {
  constexpr std::array kNames = {"left_lut", "right_lut", "left_pixel", "right_pixel", "result", "host"};
  std::string text;
  for (const Port port : order) text += (text.empty() ? "" : ", ") + std::string(kNames.at(port));
  return "[" + text + "]";
}

// The first rule of ArbitrationPolicy that the policy breaks in one of these orders, with the case.
std::string broken_rule(const ArbitrationPolicy& policy, const std::set<PriorityList>& orders) {
  for (const PriorityList& order : orders) {
    const auto text = [&](const char* rule, const PriorityList& found, const PriorityList& expected) {
      return std::string("policy ") + policy.name + " breaks the rule \"" + rule +
             "\" (models/INSIDE.md, \"How to add an arbitration policy\"): it changes the order " +
             text_of(order) + " to " + text_of(found) + ", not to " + text_of(expected);
    };
    const PriorityList idle = after(policy, order, 0, 0);
    const PriorityList idle_again = after(policy, idle, 0, 0);
    if (idle_again != idle)
      return text("after a cycle without request, further ones change nothing", idle_again, idle);
    for (const Port port : kList) {
      const PriorityList granted = after(policy, order, mask_of(port), mask_of(port));
      const PriorityList again = after(policy, granted, mask_of(port), mask_of(port));
      if (again != after(policy, granted, 0, 0))
        return text("after an uncontended grant, each further one acts as a cycle without request does",
                    again, after(policy, granted, 0, 0));
    }
  }
  return "";
}

class EveryPolicy : public testing::TestWithParam<ArbitrationPolicy> {
 protected:
  EveryPolicy() {
    std::vector<PriorityList> found = {kList};
    orders_ = {kList};
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (PortMask requests = 0; requests <= kAll; ++requests) {
        for (PortMask winner = 0; winner <= requests; winner = winner == 0 ? 1 : winner << 1U) {
          if ((winner & ~requests) != 0) continue;
          const PriorityList order = after(GetParam(), found[i], requests, winner);
          if (orders_.insert(order).second) found.push_back(order);
        }
      }
    }
  }

  std::set<PriorityList> orders_;
};

TEST_P(EveryPolicy, OrdersAllPorts) {
  for (const PriorityList& order : orders_)
    ASSERT_TRUE(std::is_permutation(order.begin(), order.end(), kList.begin(), kList.end()));
}

TEST_P(EveryPolicy, KeepsTheRulesByWhichCyclesAreSkipped) { EXPECT_EQ(broken_rule(GetParam(), orders_), ""); }

TEST(BrokenRule, IsNamedWithACase) {
  const auto next_turn = [](const PriorityList&, PriorityList& order, PortMask, PortMask) {
    std::rotate(order.begin(), order.begin() + 1, order.end());
  };
  EXPECT_THAT(broken_rule({"turns", "", false, next_turn}, {kList}),
              testing::AllOf(
                  testing::StartsWith("policy turns breaks the rule \"after a cycle without req"),
                  testing::EndsWith(", not to " + text_of(after({"", "", false, next_turn}, kList, 0, 0)))));
}

TEST_P(EveryPolicy, ForgetsAsTheTableSays) {
  bool forgets = true;
  for (const PriorityList& order : orders_) {
    for (const Port port : kList)
      forgets = forgets && after(GetParam(), order, mask_of(port), mask_of(port)) == kList;
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
