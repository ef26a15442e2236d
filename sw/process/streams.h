#pragma once

#include <string>
#include <string_view>

namespace stereotlm::process {

// To standard output. A reader that has closed its end of the pipe has seen enough: no error. Throws
// std::runtime_error if the text cannot be written for another reason (disk full).
void print(std::string_view text);

// One line on standard error: "stereotlm: KIND: text".
void say(const std::string& kind, const std::string& text);

// Reserves descriptors 0, 1 and 2 where the caller has closed them, so that no file of ours gets one of them,
// and makes a write that fails (closed pipe, file size limit) an error code instead of the end of the
// process.
void prepare_streams();

}  // namespace stereotlm::process
