#pragma once

#include <array>
#include <string_view>

#include "models/memory/memory_config.h"

namespace stereotlm::area {

// A package of the XC2V6000, and its user I/O (Xilinx DS031). The other devices' packages are left out.
struct Package {
  std::string_view name;  // in board files: "ff1152"
  int user_pins;          // I/O for the user's design
};
// The device for which a board may name a package, and its packages.
inline constexpr std::string_view kDeviceWithPackages = "xc2v6000";
inline constexpr std::array<Package, 2> kPackages = {{{"ff1152", 824}, {"ff1517", 1104}}};

// Returns the package of this name, or null.
inline const Package* find_package(std::string_view name) {
  for (const Package& package : kPackages) {
    if (package.name == name) return &package;
  }
  return nullptr;
}

// The pins of the FPGA that a bank takes. Banks without a buffer take none.
struct BankPins {
  int data = 32;     // qdr: 16 each way, a bit on both edges of the clock
  int control = 10;  // ours: clock, select, commands, 4 byte enables
  int address = 0;   // bits of a word's address; of sdram see pins_of()

  int all() const { return data + control + address; }  // the sum of the three
};

// The address pins of sdram take the row first, then the column. One more bit of the column says whether all
// internal banks are meant.
BankPins pins_of(const memory::SsramBankConfig& bank);

// Of all boards (ours). The cameras come over PCI.
inline constexpr int kLocalBusPins = 48;
inline constexpr int kOtherPins = 12;  // clocks, reset, status

}  // namespace stereotlm::area
