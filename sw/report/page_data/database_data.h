#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stereotlm::report {

// The part `database` of a page's data (sw/report/page/README.md): the points of a database of `sweep`.
// Throws sqlite::DatabaseError if the file cannot be read or is no such database, and std::runtime_error if
// it has no points.
nlohmann::ordered_json database_data(const std::string& path);

}  // namespace stereotlm::report
