#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace stereotlm::platform {

// An identity, with both sides.
struct Identity {
  std::string what;         // name of the left value
  std::uint64_t left = 0;   // value of the left side
  std::string as;           // name of the right value
  std::uint64_t right = 0;  // value of the right side
};

// Checks identities between counters (contract section 6), and collects a message for each that does not
// hold. `what` and `as` name the two values in the message.
class Audit {
 public:
  // `compared`, unless null, gets each identity.
  explicit Audit(std::vector<Identity>* compared = nullptr) : compared_(compared) {}

  // Fails unless both are equal.
  void equal(const std::string& what, std::uint64_t left, const std::string& as, std::uint64_t right);
  // Of whole numbers, or of `double`.
  template <class Number>
  void at_most(const std::string& what, Number value, const std::string& as, Number limit);
  void fail(std::string message) { failed_.push_back(std::move(message)); }
  const std::vector<std::string>& failed() const { return failed_; }

 private:
  std::vector<Identity>* compared_;
  std::vector<std::string> failed_;
};

}  // namespace stereotlm::platform
