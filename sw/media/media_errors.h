#pragma once

#include <string>

namespace stereotlm::media {

// Throws std::runtime_error with "'PATH': FOUND: RULE", the form of all errors about picture and video files.
// `found`: what is wrong with the file; `rule`: the requirement that it breaks.
[[noreturn]] void throw_media_error(const std::string& path, const std::string& found,
                                    const std::string& rule);

// Throws such an error if `path` is no regular file.
void check_regular_file(const std::string& path, const std::string& rule);

}  // namespace stereotlm::media
