#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <systemc>
#include <tlm>

namespace stereotlm::memory {

// The stored bytes of SsramBank and HostMemory, with the operations of a base-protocol target. They are zeros
// at first; untouched pages take no memory of the simulating machine.
class Ram {
 public:
  // Throws std::bad_alloc.
  explicit Ram(std::uint64_t bytes)
      : bytes_(bytes), data_(static_cast<unsigned char*>(std::calloc(bytes, 1))) {
    if (data_ == nullptr) throw std::bad_alloc();
  }

  std::uint64_t bytes() const { return bytes_; }
  unsigned char* data() { return data_.get(); }
  const unsigned char* data() const { return data_.get(); }
  // Whether all these bytes are inside the memory.
  bool holds(std::uint64_t address, std::uint64_t length) const {
    return address <= bytes_ && length <= bytes_ - address;
  }

  // Executes a read or a write with its byte enables. All its bytes must be inside the memory.
  void move(tlm::tlm_generic_payload& access) {
    unsigned char* stored = data_.get() + access.get_address();
    unsigned char* data = access.get_data_ptr();
    const bool reads = access.is_read();
    const unsigned length = access.get_data_length();
    const unsigned char* enables = access.get_byte_enable_ptr();
    if (enables == nullptr) {
      std::memcpy(reads ? data : stored, reads ? stored : data, length);
      return;
    }
    const unsigned enable_length = access.get_byte_enable_length();
    for (unsigned byte = 0; byte < length; ++byte) {
      if (enables[byte % enable_length] != TLM_BYTE_ENABLED) continue;
      (reads ? data[byte] : stored[byte]) = reads ? stored[byte] : data[byte];
    }
  }

  // Debug transport: moves the bytes that lie inside the memory, and returns their number.
  unsigned debug(tlm::tlm_generic_payload& access) {
    const std::uint64_t address = access.get_address();
    if (access.get_command() == tlm::TLM_IGNORE_COMMAND || address >= bytes_) return 0;
    const auto length =
        static_cast<unsigned>(std::min<std::uint64_t>(access.get_data_length(), bytes_ - address));
    unsigned char* stored = data_.get() + address;
    unsigned char* data = access.get_data_ptr();
    std::memcpy(access.is_read() ? data : stored, access.is_read() ? stored : data, length);
    return length;
  }

  // Grants DMI to the whole memory, for reads and writes, if the address is inside it. Otherwise returns
  // false, and `dmi` is the range beyond the memory.
  bool grant_dmi(const tlm::tlm_generic_payload& access, const sc_core::sc_time& read_time,
                 tlm::tlm_dmi& dmi) {
    dmi.allow_read_write();
    if (access.get_address() >= bytes_) {
      dmi.set_start_address(bytes_);
      dmi.set_end_address(UINT64_MAX);
      return false;
    }
    dmi.set_dmi_ptr(data_.get());
    dmi.set_start_address(0);
    dmi.set_end_address(bytes_ - 1);
    dmi.set_read_latency(read_time);
    dmi.set_write_latency(sc_core::SC_ZERO_TIME);
    return true;
  }

 private:
  struct Free {
    void operator()(void* memory) const { std::free(memory); }
  };

  std::uint64_t bytes_;
  std::unique_ptr<unsigned char[], Free> data_;
};

}  // namespace stereotlm::memory
