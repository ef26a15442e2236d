#pragma once

namespace stereotlm::cli {

inline constexpr const char* kVersion = STEREOTLM_VERSION;  // the project's, from CMake

}  // namespace stereotlm::cli
