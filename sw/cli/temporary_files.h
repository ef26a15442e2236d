#pragma once

#include <memory>
#include <stdexcept>

#include "sw/cli/problems.h"
#include "sw/report/temporary_folder.h"

namespace stereotlm::cli {

// A folder for temporary files, made before a command has done anything. Null, and reported, if there can be
// none.
inline std::unique_ptr<report::TemporaryFolder> temporary_folder(Problems& problems) {
  try {
    return std::make_unique<report::TemporaryFolder>();
  } catch (const std::runtime_error& error) {
    problems.add(error.what());
    return nullptr;
  }
}

}  // namespace stereotlm::cli
