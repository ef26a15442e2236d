#pragma once

#include <string>
#include <vector>

namespace stereotlm::stats {

// The differences of two texts of stats.json, one line each: "/banks/0/reads: fast 5, cycle 6". A key that
// only one text has is "absent" in the other. Throws std::runtime_error if a text is not JSON.
std::vector<std::string> stats_differences(const std::string& first, const std::string& second,
                                           const std::string& first_name, const std::string& second_name);

}  // namespace stereotlm::stats
