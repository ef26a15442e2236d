#include "models/testing/payload_rules.h"

#include <algorithm>

#include "models/access_text.h"
#include "models/kernel_time.h"

namespace stereotlm::test {
namespace {

constexpr unsigned int kWordBytes = 4;

bool transfers_data(const tlm::tlm_generic_payload& payload) {
  return payload.get_command() != tlm::TLM_IGNORE_COMMAND;
}

// A payload can hold values that are not enumerators.
bool is_command(tlm::tlm_command command) {
  return command == tlm::TLM_READ_COMMAND || command == tlm::TLM_WRITE_COMMAND ||
         command == tlm::TLM_IGNORE_COMMAND;
}

bool is_final_response(tlm::tlm_response_status status) {
  return status >= tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE && status <= tlm::TLM_OK_RESPONSE &&
         status != tlm::TLM_INCOMPLETE_RESPONSE;
}

void check_words(const tlm::tlm_generic_payload& payload, Problems& problems) {
  if (payload.get_data_length() % kWordBytes != 0) {
    problems.push_back("data length = " + std::to_string(payload.get_data_length()) +
                       ": must be a multiple of 4 on this link");
  }
  if (payload.get_address() % kWordBytes != 0) {
    problems.push_back("address = " + hex(payload.get_address()) + ": must be 4-aligned on this link");
  }
  if (payload.get_streaming_width() % kWordBytes != 0) {
    problems.push_back("streaming width = " + std::to_string(payload.get_streaming_width()) +
                       ": must be a multiple of 4 on this link");
  }
}

void check_byte_enables(const tlm::tlm_generic_payload& payload, Problems& problems) {
  const unsigned char* enables = payload.get_byte_enable_ptr();
  if (enables == nullptr) return;
  const unsigned int length = payload.get_byte_enable_length();
  if (length == 0) {
    problems.emplace_back("byte enable length = 0 with a byte enable pointer: must be positive (14.14 f)");
  }
  const auto* odd = std::find_if(enables, enables + length, [](unsigned char enable) {
    return enable != TLM_BYTE_ENABLED && enable != TLM_BYTE_DISABLED;
  });
  if (odd != enables + length) {
    problems.push_back("byte enable[" + std::to_string(odd - enables) + "] = " + hex(*odd) +
                       ": must be 0x0 or 0xff (14.13)");
  }
}

void check_full_or_minimal_option(const tlm::tlm_generic_payload& payload, Problems& problems) {
  const auto option = payload.get_gp_option();
  if (option != tlm::TLM_MIN_PAYLOAD && option != tlm::TLM_FULL_PAYLOAD) {
    problems.push_back("gp_option = " + std::to_string(option) +
                       ": must be TLM_MIN_PAYLOAD or TLM_FULL_PAYLOAD here (14.8)");
  }
}

// The defaults that an initiator sets with TLM_FULL_PAYLOAD.
void check_response_fields(const tlm::tlm_generic_payload& payload, Problems& problems) {
  if (payload.get_response_status() != tlm::TLM_INCOMPLETE_RESPONSE) {
    problems.push_back("response status = " + payload.get_response_string() +
                       ": must be TLM_INCOMPLETE_RESPONSE with TLM_FULL_PAYLOAD (14.8 e, f)");
  }
  if (payload.is_dmi_allowed())
    problems.emplace_back("dmi_allowed = true: must be false with TLM_FULL_PAYLOAD (14.8 e, f)");
}

}  // namespace

Problems request_problems(const tlm::tlm_generic_payload& payload, const ProtocolOptions& options) {
  Problems problems;
  if (!is_command(payload.get_command())) {
    problems.push_back("command = " + std::to_string(payload.get_command()) +
                       ": must be read, write or ignore (14.9)");
  }
  if (transfers_data(payload)) {
    if (payload.get_data_length() == 0) {
      problems.emplace_back("data length = 0: must be positive for a read or a write (14.12 d)");
    }
    if (payload.get_data_ptr() == nullptr) {
      problems.emplace_back("data pointer = null: must point to the data (14.11 e)");
    }
    if (options.whole_words) check_words(payload, problems);
  }
  if (payload.get_streaming_width() == 0) {
    problems.emplace_back("streaming width = 0: must be positive (14.15 f)");
  } else if (options.whole_words && payload.get_streaming_width() < payload.get_data_length()) {
    problems.push_back("streaming width = " + std::to_string(payload.get_streaming_width()) +
                       ": must be at least the data length, " + std::to_string(payload.get_data_length()) +
                       ", as no streaming burst is meant on this link (14.15)");
  }
  check_byte_enables(payload, problems);
  if (payload.get_response_status() != tlm::TLM_INCOMPLETE_RESPONSE) {
    problems.push_back("response status = " + payload.get_response_string() +
                       ": must be TLM_INCOMPLETE_RESPONSE in a request (14.17 e)");
  }
  if (payload.is_dmi_allowed())
    problems.emplace_back("dmi_allowed = true: must be false in a request (14.16)");
  if (payload.get_gp_option() != tlm::TLM_MIN_PAYLOAD) {
    problems.push_back("gp_option = " + std::to_string(payload.get_gp_option()) +
                       ": must be TLM_MIN_PAYLOAD in a transport call (14.8 g)");
  }
  return problems;
}

Problems response_problems(const tlm::tlm_generic_payload& payload, const ProtocolOptions& options) {
  if (is_final_response(payload.get_response_status())) return {};
  if (!options.final_status && payload.get_response_status() == tlm::TLM_INCOMPLETE_RESPONSE) return {};
  return {"response status = " + std::to_string(payload.get_response_status()) +
          ": must be OK or an error in a response (14.17)"};
}

std::string open_problem(sc_dt::uint64 address, const sc_core::sc_time& begin) {
  return "the access to address " + hex(address) + " that began at " + kernel_time::text_of(begin) +
         " is open: must end before the simulation does";
}

Problems debug_request_problems(const tlm::tlm_generic_payload& payload) {
  Problems problems;
  if (!is_command(payload.get_command())) {
    problems.push_back("command = " + std::to_string(payload.get_command()) +
                       ": must be read, write or ignore (14.9)");
  }
  if (payload.get_data_length() > 0 && payload.get_data_ptr() == nullptr) {
    problems.emplace_back("data pointer = null: must point to the data (11.3.4 l)");
  }
  check_full_or_minimal_option(payload, problems);
  if (payload.get_gp_option() == tlm::TLM_FULL_PAYLOAD) {
    check_response_fields(payload, problems);
    check_byte_enables(payload, problems);
    if (payload.get_streaming_width() == 0)
      problems.emplace_back("streaming width = 0: must be positive (14.15 f)");
  }
  return problems;
}

Problems debug_answer_problems(const tlm::tlm_generic_payload& payload, unsigned int bytes) {
  if (bytes <= payload.get_data_length()) return {};
  return {"returned count = " + std::to_string(bytes) + ": must not exceed the data length, " +
          std::to_string(payload.get_data_length()) + " (11.3.4 s)"};
}

Problems dmi_request_problems(const tlm::tlm_generic_payload& payload, const tlm::tlm_dmi& dmi) {
  Problems problems;
  if (payload.get_command() != tlm::TLM_READ_COMMAND && payload.get_command() != tlm::TLM_WRITE_COMMAND) {
    problems.push_back("command = " + std::to_string(payload.get_command()) +
                       ": must be read or write in a DMI request (11.2.4)");
  }
  check_full_or_minimal_option(payload, problems);
  if (payload.get_gp_option() == tlm::TLM_FULL_PAYLOAD) {
    check_response_fields(payload, problems);
    if (payload.get_byte_enable_ptr() != nullptr || payload.get_byte_enable_length() != 0 ||
        payload.get_streaming_width() != 0) {
      problems.emplace_back("byte enables or streaming width: must be 0 with TLM_FULL_PAYLOAD (14.8 e)");
    }
  }
  const tlm::tlm_dmi fresh;
  if (dmi.get_dmi_ptr() != fresh.get_dmi_ptr() || dmi.get_start_address() != fresh.get_start_address() ||
      dmi.get_end_address() != fresh.get_end_address() ||
      dmi.get_granted_access() != fresh.get_granted_access() ||
      dmi.get_read_latency() != fresh.get_read_latency() ||
      dmi.get_write_latency() != fresh.get_write_latency()) {
    problems.emplace_back("DMI descriptor: must be as after init() in a request (11.2.5)");
  }
  return problems;
}

Problems dmi_answer_problems(const tlm::tlm_generic_payload& payload, sc_dt::uint64 address, bool granted,
                             const tlm::tlm_dmi& dmi) {
  Problems problems;
  const std::string range = "DMI range = " + hex(dmi.get_start_address()) + ".." + hex(dmi.get_end_address());
  if (dmi.get_start_address() > dmi.get_end_address()) {
    problems.push_back(range + ": must not end before it starts (11.2.5)");
  } else if (address < dmi.get_start_address() || address > dmi.get_end_address()) {
    problems.push_back(range + ": must contain the requested address " + hex(address) + " (11.2.5)");
  }
  if (!granted) return problems;
  if (dmi.get_dmi_ptr() == nullptr) {
    problems.emplace_back("DMI pointer = null: must point to the memory when access is granted (11.2.5)");
  }
  const bool covers = payload.is_read() ? dmi.is_read_allowed() : dmi.is_write_allowed();
  if (!covers) {
    problems.push_back("granted access = " + std::to_string(dmi.get_granted_access()) +
                       ": must include the requested one (11.2.5)");
  }
  return problems;
}

PayloadSnapshot::PayloadSnapshot(const tlm::tlm_generic_payload& payload, bool uses_data, bool uses_enables)
    : command_(payload.get_command()),
      address_(payload.get_address()),
      data_(payload.get_data_ptr()),
      data_length_(payload.get_data_length()),
      streaming_width_(payload.get_streaming_width()),
      byte_enables_(payload.get_byte_enable_ptr()),
      byte_enable_length_(payload.get_byte_enable_length()),
      gp_option_(payload.get_gp_option()) {
  if (uses_data && command_ != tlm::TLM_READ_COMMAND && data_ != nullptr)
    written_.assign(data_, data_ + data_length_);
  if (uses_enables && byte_enables_ != nullptr)
    enables_.assign(byte_enables_, byte_enables_ + byte_enable_length_);
}

Problems PayloadSnapshot::changes(const tlm::tlm_generic_payload& payload,
                                  const ProtocolOptions& options) const {
  Problems problems;
  const auto check = [&problems](bool same, const char* what) {
    if (!same) problems.push_back(std::string(what) + " changed: only the initiator may set it (14.7)");
  };
  check(payload.get_command() == command_, "command");
  if (options.fixed_address && payload.get_address() != address_) {
    problems.push_back("address changed from " + hex(address_) + " to " + hex(payload.get_address()) +
                       ": a target may not modify it (14.7)");
  }
  check(payload.get_data_ptr() == data_, "data pointer");
  check(payload.get_data_length() == data_length_, "data length");
  check(payload.get_streaming_width() == streaming_width_, "streaming width");
  check(payload.get_byte_enable_ptr() == byte_enables_, "byte enable pointer");
  check(payload.get_byte_enable_length() == byte_enable_length_, "byte enable length");
  check(std::equal(written_.begin(), written_.end(), data_), "data array of a write or an ignored command");
  check(std::equal(enables_.begin(), enables_.end(), byte_enables_), "byte enable array");
  const bool accepted =
      gp_option_ == tlm::TLM_FULL_PAYLOAD && payload.get_gp_option() == tlm::TLM_FULL_PAYLOAD_ACCEPTED;
  check(accepted || payload.get_gp_option() == gp_option_, "gp_option");
  return problems;
}

ResponseSnapshot::ResponseSnapshot(const tlm::tlm_generic_payload& payload)
    : status_(payload.get_response_status()),
      dmi_allowed_(payload.is_dmi_allowed()),
      data_(payload.get_data_ptr()) {
  if (payload.is_read() && data_ != nullptr) read_.assign(data_, data_ + payload.get_data_length());
}

Problems ResponseSnapshot::changes(const tlm::tlm_generic_payload& payload) const {
  Problems problems;
  const auto check = [&problems](bool same, const char* what) {
    if (!same) problems.push_back(std::string(what) + " changed after the response was sent (14.7 g)");
  };
  check(payload.get_response_status() == status_, "response status");
  check(dmi_allowed_ || !payload.is_dmi_allowed(),
        "dmi_allowed");  // an interconnect above may clear it (14.7 h)
  check(std::equal(read_.begin(), read_.end(), data_), "data array of a read");
  return problems;
}

}  // namespace stereotlm::test
