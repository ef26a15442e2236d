#pragma once

#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/value_reader.h"
#include "platform/yaml/yaml_tree.h"

namespace stereotlm::platform {

// Reads a board from its tree, after the values of the preset and of `--set` were merged into the tree.
// Appends each problem to `findings`; the result is valid only if nothing was appended. `report_missing`:
// whether a missing key is a problem; false if the preset that should supply it does not exist.
BoardConfig read_board(const YamlNode& tree, bool report_missing, std::vector<Finding>& findings);

}  // namespace stereotlm::platform
