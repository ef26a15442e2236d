#include "models/fpga/local_bus.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "models/kernel_time.h"
#include "models/memory/crossbar.h"

namespace stereotlm::fpga {
namespace {

constexpr std::uint64_t kFirstWordClock = 2;  // after the address clock and the decode clock
constexpr bool is_register(std::uint64_t address) { return address >= kLocalRegisters; }

double checked(double clock_mhz) {
  if (clock_mhz >= 1 && clock_mhz <= 1000) return clock_mhz;
  throw std::invalid_argument("clock_mhz = " + std::to_string(clock_mhz) + ": must be 1..1000");
}

}  // namespace

LocalBus::LocalBus(const sc_core::sc_module_name& name, const LocalBusConfig& config, std::size_t banks)
    : sc_module(name),
      clock_(checked(config.clock_mhz)),
      banks_(banks),
      buffers_(config.buffers),
      words_granted_(config.buffers) {
  kernel_time::check_resolution();
  SC_HAS_PROCESS(LocalBus);
  memory::kBankCountRule.required("banks", static_cast<int>(banks));
  bus.bind(*this);
  memory.register_invalidate_direct_mem_ptr(this, &LocalBus::invalidate_dmi);
  SC_THREAD(run_registers);
}

tlm::tlm_response_status LocalBus::check(const tlm::tlm_generic_payload& access) const {
  const std::uint64_t first = access.get_address();
  const std::uint64_t bytes = access.get_data_length();
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (access.get_byte_enable_ptr() != nullptr) return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  if (bytes == 0 || bytes % 4 != 0 || access.get_streaming_width() < bytes)
    return tlm::TLM_BURST_ERROR_RESPONSE;
  if (first % 4 != 0) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (is_register(first)) return tlm::TLM_OK_RESPONSE;
  if (memory::bank_of_address(first) >= banks_) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  return memory::bank_of_address(first + bytes - 1) == memory::bank_of_address(first)
             ? tlm::TLM_OK_RESPONSE
             : tlm::TLM_BURST_ERROR_RESPONSE;
}

void LocalBus::b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time&) {
  ++stats_.errors;
  access.set_response_status(tlm::TLM_GENERIC_ERROR_RESPONSE);
}

tlm::tlm_sync_enum LocalBus::nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                             sc_core::sc_time& delay) {
  if (phase == tlm::END_RESP && responding_) {
    responding_ = false;
    burst_ = nullptr;
    return tlm::TLM_COMPLETED;
  }
  if (phase != tlm::BEGIN_REQ || burst_ != nullptr) {
    SC_REPORT_ERROR("/stereotlm/local_bus", (std::string(name()) + ": phase out of order").c_str());
    return tlm::TLM_ACCEPTED;
  }
  if (const tlm::tlm_response_status status = check(access); status != tlm::TLM_OK_RESPONSE) {
    ++stats_.errors;
    access.set_response_status(status);
    return tlm::TLM_COMPLETED;
  }
  begin(access, delay);
  return tlm::TLM_ACCEPTED;
}

void LocalBus::begin(tlm::tlm_generic_payload& access, const sc_core::sc_time& delay) {
  access.acquire();
  burst_ = &access;
  status_ = tlm::TLM_OK_RESPONSE;
  next_word_ = 0;
  ++stats_.bursts;
  const std::uint64_t now = kernel_time::to_ps(sc_core::sc_time_stamp());
  stats_.busy_clocks += idle_clock_ - address_clock_;
  address_clock_ = clock_.edge_at_or_after(now + kernel_time::to_ps(delay));
  idle_clock_ = kUnknown;
  request_ps_ = clock_.edge_ps(address_clock_ + kFirstWordClock + 1);
  if (is_register(access.get_address())) {
    register_event_.notify(kernel_time::to_time(request_ps_ - now));
    return;
  }
  words_left_ = access.get_data_length() / 4;
  const std::uint64_t first = access.get_address();
  route_out->push(
      {memory::bank_of_address(first), access.is_write(), first, first + access.get_data_length()});
  // The receiver of the push may have granted all words.
  if (words_left_ != 0) request_event_.notify(kernel_time::to_time(request_ps_ - now));
}

// Transfers one word of the burst, at `address` on the socket of `through`.
bool LocalBus::transfer(memory::WordAccess& through, std::uint64_t address, sc_core::sc_time& delay) {
  unsigned char* const data = burst_->get_data_ptr() + next_word_ * 4;
  ++next_word_;
  std::uint32_t word = 0;
  if (burst_->is_write()) {
    std::memcpy(&word, data, 4);
    through.write(address, word, delay);
  } else {
    through.read(address, delay);
    word = through.word();
    std::memcpy(data, &word, 4);
  }
  if (through.status() == tlm::TLM_OK_RESPONSE) return true;
  ++stats_.errors;
  if (status_ == tlm::TLM_OK_RESPONSE) status_ = through.status();
  return false;
}

void LocalBus::access(const sc_core::sc_time& at, std::uint64_t grant_ps, std::uint64_t usable_ps) {
  sc_core::sc_time delay = at;
  const std::uint64_t address = burst_->get_address() + next_word_ * 4;
  const bool taken = transfer(memory_access_, address, delay);
  if (taken) {
    ++(burst_->is_write() ? stats_.words_written : stats_.words_read);
    if (burst_->is_write()) words_granted_.add(address, 1);
  }
  advance(1, grant_ps, usable_ps);
}

void LocalBus::move_words(unsigned char* words) {
  unsigned char* const data = burst_->get_data_ptr() + next_word_ * 4;
  const std::size_t bytes = words_left_ * 4;
  std::memcpy(burst_->is_write() ? words : data, burst_->is_write() ? data : words, bytes);
}

void LocalBus::count_granted(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps) {
  (burst_->is_write() ? stats_.words_written : stats_.words_read) += words;
  if (burst_->is_write()) words_granted_.add(burst_->get_address() + next_word_ * 4, words);
  next_word_ += words;
  advance(words, grant_ps, usable_ps);
}

// `words` words have been granted: proceeds to the next word, or ends the burst.
void LocalBus::advance(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps) {
  words_left_ -= words;
  if (words_left_ != 0) {
    request_ps_ = clock_.edge_ps(clock_.edge_at_or_after(grant_ps) + 1);
    return;
  }
  route_out->push({});
  end(burst_->is_write() || status_ != tlm::TLM_OK_RESPONSE ? grant_ps : usable_ps);
}

void LocalBus::run_registers() {
  for (;;) {
    wait(register_event_);
    access_register();
  }
}

void LocalBus::access_register() {
  sc_core::sc_time delay;
  transfer(register_access_, burst_->get_address() - kLocalRegisters + next_word_ * 4, delay);
  ++stats_.register_accesses;
  const std::uint64_t now = kernel_time::to_ps(sc_core::sc_time_stamp());
  if (next_word_ == burst_->get_data_length() / 4) {
    end(now);
    return;
  }
  register_event_.notify(kernel_time::to_time(clock_.edge_ps(clock_.edge_at_or_after(now) + 1) - now));
}

// Ends the burst; the bus is free after the idle clock.
void LocalBus::end(std::uint64_t last_clock_end_ps) {
  idle_clock_ = clock_.edge_at_or_after(last_clock_end_ps);
  tlm::tlm_generic_payload& access = *burst_;
  access.set_response_status(status_);
  responding_ = true;
  tlm::tlm_phase phase = tlm::BEGIN_RESP;
  sc_core::sc_time delay = kernel_time::to_time(clock_.edge_ps(idle_clock_ + 1)) - sc_core::sc_time_stamp();
  const tlm::tlm_sync_enum answer = bus->nb_transport_bw(access, phase, delay);
  if (answer == tlm::TLM_COMPLETED || (answer == tlm::TLM_UPDATED && phase == tlm::END_RESP)) {
    responding_ = false;
    burst_ = nullptr;
  }
  access.release();
}

LocalBus::Stats LocalBus::stats() const {
  Stats stats = stats_;
  stats.clocks = clock_.edge_at_or_after(kernel_time::to_ps(sc_core::sc_time_stamp()) + 1) - 1;
  const std::uint64_t end = std::min(idle_clock_, stats.clocks);
  stats.busy_clocks += end > address_clock_ ? end - address_clock_ : 0;
  return stats;
}

WordsByRange LocalBus::words_to_grant() const {
  WordsByRange words(buffers_);
  if (words_left_ != 0 && burst_->is_write()) words.add(burst_->get_address() + next_word_ * 4, words_left_);
  return words;
}

unsigned LocalBus::transport_dbg(tlm::tlm_generic_payload& access) {
  const std::uint64_t address = access.get_address();
  if (!is_register(address)) return memory->transport_dbg(access);
  access.set_address(address - kLocalRegisters);
  const unsigned length = registers->transport_dbg(access);
  access.set_address(address);
  return length;
}

bool LocalBus::get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) {
  return memory->get_direct_mem_ptr(access, dmi);
}

void LocalBus::invalidate_dmi(sc_dt::uint64 start, sc_dt::uint64 end) {
  bus->invalidate_direct_mem_ptr(start, end);
}

}  // namespace stereotlm::fpga
