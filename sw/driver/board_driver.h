#pragma once

#include <cstdint>

#include "platform/config/board_config.h"
#include "sw/driver/stereo_driver.h"

namespace stereotlm::driver {

// The configuration of a board's driver.
DriverConfig driver_config(const platform::BoardConfig& board, std::uint64_t frames);

}  // namespace stereotlm::driver
