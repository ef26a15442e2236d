#include "platform/figures/audit.h"

#include <fmt/format.h>

namespace stereotlm::platform {

void Audit::equal(const std::string& what, std::uint64_t left, const std::string& as, std::uint64_t right) {
  if (compared_ != nullptr) compared_->push_back({what, left, as, right});
  if (left != right) fail(fmt::format("{} = {}, but {} = {}", what, left, as, right));
}

template <class Number>
void Audit::at_most(const std::string& what, Number value, const std::string& as, Number limit) {
  if (value > limit) fail(fmt::format("{} = {}, but {} = {}", what, value, as, limit));
}

template void Audit::at_most(const std::string&, std::uint64_t, const std::string&, std::uint64_t);
template void Audit::at_most(const std::string&, double, const std::string&, double);

}  // namespace stereotlm::platform
