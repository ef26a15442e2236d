#include "models/pci/bridge_register_file.h"

namespace stereotlm::pci {

using namespace bridge;

BridgeRegisterFile::Decoded BridgeRegisterFile::decode(std::uint64_t offset) {
  if (offset < kInterruptStatus) return {kPage, static_cast<std::size_t>((offset - kPage) / 4)};
  if (offset < kDmaDescriptor) return {offset, 0};
  const std::uint64_t in_channels = offset - kDmaDescriptor;
  return {kDmaDescriptor + in_channels % kChannelStride,
          static_cast<std::size_t>(in_channels / kChannelStride)};
}

bool BridgeRegisterFile::allows(bool write, std::uint64_t offset) {
  switch (decode(offset).name) {
    case kPage:
    case kInterruptStatus:
    case kInterruptEnable:
    case kDmaDescriptor:
      return true;
    case kDmaControl:
      return write;
    case kDmaStatus:
      return !write;
    default:
      return false;
  }
}

std::uint32_t BridgeRegisterFile::read(std::uint64_t offset) const {
  const auto [name, index] = decode(offset);
  switch (name) {
    case kPage:
      return pages_[index];
    case kInterruptStatus:
      return interrupt_status_;
    case kInterruptEnable:
      return interrupt_enable_;
    case kDmaDescriptor:
      return channels_[index].descriptor();
    default:
      return std::uint32_t{channels_[index].busy()};
  }
}

DmaChannel* BridgeRegisterFile::write(std::uint64_t offset, std::uint32_t value) {
  const auto [name, index] = decode(offset);
  switch (name) {
    case kPage:
      pages_[index] = value;
      break;
    case kInterruptStatus:
      interrupt_status_ &= ~value;
      break;
    case kInterruptEnable:
      interrupt_enable_ = value & kAllInterrupts;
      break;
    case kDmaDescriptor:
      channels_[index].set_descriptor(value);
      break;
    default:
      if ((value & 1U) != 0) return &channels_[index];
  }
  return nullptr;
}

}  // namespace stereotlm::pci
