#pragma once

#include <string>

namespace stereotlm::media {

// The one form of an error about a picture or video file.
[[noreturn]] void refuse(const std::string& path, const std::string& found, const std::string& rule);

// Refuses a path where there is no regular file; `rule` says what there must be.
void check_regular_file(const std::string& path, const std::string& rule);

}  // namespace stereotlm::media
