#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace stereotlm::explore {

// Does pieces of work 0..count-1 in `processes` processes, which are forked from this one and see all that it
// knows. `work`, in such a process, returns the result of a piece; `take`, in this process, gets it, in any
// order. `keep_going` is called several times a second; after it has returned false, no further piece is
// begun, and those that have begun are given up. Returns false then. Throws the exception that `work` has
// thrown, and std::runtime_error if a process has died.
bool do_in_processes(std::size_t count, unsigned processes,
                     const std::function<std::string(std::size_t)>& work,
                     const std::function<void(std::size_t, const std::string&)>& take,
                     const std::function<bool()>& keep_going);

}  // namespace stereotlm::explore
