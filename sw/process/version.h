#pragma once

namespace stereotlm::process {

inline constexpr const char* kVersion = STEREOTLM_VERSION;  // the project's, from CMake

}  // namespace stereotlm::process
