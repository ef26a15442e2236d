#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace stereotlm::platform {

// Checks identities between counters (contract section 6), and collects a message for each that does not
// hold. `what` and `as` name the two values in the message.
class Audit {
 public:
  void equal(const std::string& what, std::uint64_t left, const std::string& as, std::uint64_t right) {
    if (left == right) return;
    fail(fmt::format("{} = {}, but {} = {}", what, left, as, right));
  }
  template <class Number>
  void at_most(const std::string& what, Number value, const std::string& as, Number limit) {
    if (value <= limit) return;
    fail(fmt::format("{} = {}, but {} = {}", what, value, as, limit));
  }
  void fail(std::string message) { failed_.push_back(std::move(message)); }
  const std::vector<std::string>& failed() const { return failed_; }

 private:
  std::vector<std::string> failed_;
};

}  // namespace stereotlm::platform
