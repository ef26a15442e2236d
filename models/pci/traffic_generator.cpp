#include "models/pci/traffic_generator.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "models/checked.h"
#include "models/kernel_time.h"

namespace stereotlm::pci {

TrafficGenerator::TrafficGenerator(const sc_core::sc_module_name& name, const TrafficGeneratorConfig& config)
    : sc_module(name), config_(checked(this->name(), config)) {
  device.register_b_transport(this, &TrafficGenerator::respond);
}

PciBurst TrafficGenerator::begin_burst(std::uint64_t /*address_clock_ps*/) {
  words_.resize(static_cast<std::size_t>(config_.burst_words) - words_done_);
  return {false, config_.address + 4 * words_done_, &words_};
}

void TrafficGenerator::end_burst(const BurstResult& result) {
  if (is_error(result.end)) {
    SC_REPORT_ERROR(
        "/stereotlm/traffic_generator",
        (std::string(name()) + ": address = " + std::to_string(config_.address) + ": " +
         (result.end == BurstEnd::kMasterAbort ? "no target answers" : "the target answers with an error"))
            .c_str());
    return;
  }
  words_done_ += result.words;
  if (result.end != BurstEnd::kComplete) {
    pci->request(*this);
    return;
  }
  words_done_ = 0;
  ++transfers_;
  const std::uint64_t due_ps = config_.first_request_ps + transfers_ * config_.interval_ps;
  pci->request(*this, std::max(due_ps, kernel_time::now_ps()));
}

void TrafficGenerator::respond(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  if (!access.is_read()) {
    access.set_response_status(tlm::TLM_COMMAND_ERROR_RESPONSE);
  } else if (access.get_data_length() % 4 != 0 || access.get_streaming_width() < access.get_data_length()) {
    access.set_response_status(tlm::TLM_BURST_ERROR_RESPONSE);
  } else if (access.get_byte_enable_ptr() != nullptr) {
    access.set_response_status(tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  } else {
    std::memset(access.get_data_ptr(), 0, access.get_data_length());
    delay += kernel_time::to_time(config_.access_ps);
    access.set_response_status(tlm::TLM_OK_RESPONSE);
  }
}

}  // namespace stereotlm::pci
