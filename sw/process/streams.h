#pragma once

#include <csignal>
#include <string>
#include <string_view>

namespace stereotlm::process {

// If the process has a client (client.h), what this file prints goes there, without colour.

// Writes to standard output. A reader that has closed its end of the pipe is no error. Throws
// std::runtime_error if the text cannot be written for another reason, such as a full disk.
void print(std::string_view text);

// Writes one line to standard error: "stereotlm: KIND: text".
void say(const std::string& kind, const std::string& text);
// Writes a line to standard error as it is. A line of say() and a line of Problems are treated alike: the
// kind is coloured, and a note is left out after leave_out_notes().
void say_line(const std::string& line);

// Whether say() leaves out notes, and no progress is shown, from then on. Children of the process inherit
// this.
void leave_out_notes(bool left_out);
bool leaves_out_notes();

enum class Colour { kRed, kGreen, kYellow, kDim };
// The text with the escape sequences of the colour. Without them if the descriptor is no terminal, if TERM is
// `dumb`, or if NO_COLOR is set and not empty (https://no-color.org).
std::string coloured(int descriptor, Colour colour, const std::string& text);

// Opens descriptors 0, 1 and 2 if they are closed, so that no other file gets one of them. From then on, a
// write to a closed pipe or beyond the limit on file sizes fails instead of ending the process.
void prepare_streams();

// Whether the first Ctrl-C (SIGINT) or SIGTERM was caught. A signal handler may write only to a variable of
// this type.
inline volatile std::sig_atomic_t caught_interrupt = 0;

// From now on the first Ctrl-C (SIGINT) and the first SIGTERM are recorded instead of ending the process; a
// second one ends it. A signal that the caller has set to be ignored stays ignored.
void catch_interrupts();
// Whether such a signal has been recorded.
inline bool interrupted() { return caught_interrupt != 0; }

}  // namespace stereotlm::process
