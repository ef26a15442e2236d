#pragma once

namespace stereotlm::process {

// From now on the first Ctrl-C (SIGINT) and the first SIGTERM are recorded instead of ending the process; a
// second one ends it. A signal that the caller has set to be ignored stays ignored.
void catch_interrupts();

// Whether such a signal has been recorded.
bool interrupted();

}  // namespace stereotlm::process
