#pragma once

#include <string>
#include <string_view>

namespace stereotlm::process {

// Writes to standard output. A reader that has closed its end of the pipe is no error. Throws
// std::runtime_error if the text cannot be written for another reason, such as a full disk.
void print(std::string_view text);

// Writes one line to standard error: "stereotlm: KIND: text".
void say(const std::string& kind, const std::string& text);

// Opens descriptors 0, 1 and 2 where the caller has closed them, so that no other file gets one of them. From
// then on, a write to a closed pipe or beyond the limit on file sizes returns an error instead of ending the
// process.
void prepare_streams();

}  // namespace stereotlm::process
