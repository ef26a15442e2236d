#include "models/testing/scoreboard.h"

#include <string>

#include "models/kernel_time.h"
#include "models/testing/failure.h"

namespace stereotlm::test {

void Scoreboard::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  const std::uint64_t address = payload.get_address();
  try {
    AccessProbe::b_transport(payload, delay);
  } catch (...) {  // the process is killed or reset: any of its bytes may have been written
    for (unsigned byte = 0; payload.is_write() && byte < payload.get_data_length(); ++byte)
      bytes_.erase(address + byte);
    throw;
  }
}

void Scoreboard::ended(const tlm::tlm_generic_payload& payload, std::uint64_t address,
                       const sc_core::sc_time& begin, const sc_core::sc_time& end) {
  AccessProbe::ended(payload, address, begin, end);
  if (!payload.is_response_ok() || payload.get_command() == tlm::TLM_IGNORE_COMMAND) return;
  const unsigned char* const enables = payload.get_byte_enable_ptr();
  for (unsigned byte = 0; byte < payload.get_data_length(); ++byte) {
    if (enables != nullptr && enables[byte % payload.get_byte_enable_length()] != TLM_BYTE_ENABLED) continue;
    const unsigned char value = payload.get_data_ptr()[byte];
    const std::uint64_t place = address + byte % payload.get_streaming_width();
    const auto [known, is_new] = bytes_.try_emplace(place, value);
    if (payload.is_read() && !is_new) {
      ++compared_;
      if (known->second != value) {
        fail(std::string(name()) + " at " + kernel_time::text_of(end) + ": byte " + std::to_string(place) +
             " = " + std::to_string(value) + ": must be " + std::to_string(known->second));
      }
    }
    known->second = value;
  }
}

}  // namespace stereotlm::test
