#include "models/pci/bridge_register_file.h"

#include <cstring>

#include "models/register_access.h"

namespace stereotlm::pci {

using namespace bridge;

BridgeRegisterFile::Decoded BridgeRegisterFile::decode(std::uint64_t offset) {
  if (offset < kInterruptStatus) return {kPage, static_cast<std::size_t>((offset - kPage) / 4)};
  if (offset < kDmaDescriptor) return {offset, 0};
  const std::uint64_t in_channels = offset - kDmaDescriptor;
  return {kDmaDescriptor + in_channels % kChannelStride,
          static_cast<std::size_t>(in_channels / kChannelStride)};
}

// Whether the register exists and can be accessed in this direction. `name`: Decoded::name.
bool BridgeRegisterFile::allows(const tlm::tlm_generic_payload& access, std::uint64_t name) {
  switch (name) {
    case kPage:
    case kInterruptStatus:
    case kInterruptEnable:
    case kDmaDescriptor:
      return true;
    case kDmaControl:
      return access.is_write();
    case kDmaStatus:
      return access.is_read();
    default:
      return false;
  }
}

DmaChannel* BridgeRegisterFile::access(tlm::tlm_generic_payload& access) {
  tlm::tlm_response_status status = check_register_access(access, kRegisterWindowBytes);
  const Decoded at = decode(access.get_address());
  if (status == tlm::TLM_OK_RESPONSE && !allows(access, at.name)) status = tlm::TLM_COMMAND_ERROR_RESPONSE;
  access.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE) return nullptr;
  std::uint32_t value = 0;
  if (access.is_write()) {
    std::memcpy(&value, access.get_data_ptr(), 4);
    return write(at, value);
  }
  value = read(at);
  std::memcpy(access.get_data_ptr(), &value, 4);
  return nullptr;
}

std::uint32_t BridgeRegisterFile::read(const Decoded& at) const {
  switch (at.name) {
    case kPage:
      return pages_[at.index];
    case kInterruptStatus:
      return interrupt_status_;
    case kInterruptEnable:
      return interrupt_enable_;
    case kDmaDescriptor:
      return channels_[at.index].descriptor();
    default:
      return std::uint32_t{channels_[at.index].busy()};
  }
}

DmaChannel* BridgeRegisterFile::write(const Decoded& at, std::uint32_t value) {
  switch (at.name) {
    case kPage:
      pages_[at.index] = value;
      break;
    case kInterruptStatus:
      interrupt_status_ &= ~value;
      interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
      break;
    case kInterruptEnable:
      interrupt_enable_ = value & kAllInterrupts;
      interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
      break;
    case kDmaDescriptor:
      channels_[at.index].set_descriptor(value);
      break;
    default:
      if ((value & 1U) != 0) return &channels_[at.index];
  }
  return nullptr;
}

void BridgeRegisterFile::raise(std::uint32_t bits) {
  interrupt_status_ |= bits;
  interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
}

}  // namespace stereotlm::pci
