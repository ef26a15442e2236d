#pragma once

#include <string>

namespace stereotlm::media {

// An error about a picture or video file; all have this form.
[[noreturn]] void refuse(const std::string& path, const std::string& found, const std::string& rule);

// Throws if `path` is no regular file. `rule`: the requirement, for the message.
void check_regular_file(const std::string& path, const std::string& rule);

}  // namespace stereotlm::media
