#pragma once

#include <string>
#include <string_view>

namespace stereotlm::process {

// Writes to standard output. A reader that has closed its end of the pipe is no error. Throws
// std::runtime_error if the text cannot be written for another reason, such as a full disk.
void print(std::string_view text);

// Writes one line to standard error: "stereotlm: KIND: text".
void say(const std::string& kind, const std::string& text);
// Writes a line to standard error as it is. A line of say() and a line of Problems are treated alike: the
// kind is coloured, and a note is left out after leave_out_notes().
void say_line(const std::string& line);

// From then on, say() leaves out notes, and no progress is shown. Children of the process inherit this.
void leave_out_notes();
bool leaves_out_notes();

enum class Colour { kRed, kGreen, kYellow, kDim };
// The text with the escape sequences of the colour. Without them if the descriptor is no terminal, if TERM is
// `dumb`, or if NO_COLOR is set and not empty (https://no-color.org).
std::string coloured(int descriptor, Colour colour, const std::string& text);

// Opens descriptors 0, 1 and 2 where the caller has closed them, so that no other file gets one of them. From
// then on, a write to a closed pipe or beyond the limit on file sizes returns an error instead of ending the
// process.
void prepare_streams();

}  // namespace stereotlm::process
