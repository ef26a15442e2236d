#pragma once

namespace stereotlm::test {

// An exception that is thrown on the main stack after SystemC threads have run: the address sanitizer, which
// does not follow their stacks, takes it for damage (google/sanitizers issue 189). A test that needs one is
// skipped under it.
#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif
inline constexpr const char* kNoExceptions = "the address sanitizer does not follow SystemC's stacks";

}  // namespace stereotlm::test
