#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "models/memory/bank_traits.h"

namespace stereotlm::memory {

inline constexpr double kMostStandbyMw = 10'000;
inline constexpr kernels::IntegerRule kWorkEnergyRule{0, 1'000'000};  // pJ

// What a bank takes (contract section 9). Plain C++.
struct BankEnergy {
  double standby_mw;   // nobody accesses it: mW to the nearest uW, 0..kMostStandbyMw
  int access_pj;       // an access: pJ beyond standby, kWorkEnergyRule
  int row_pj = 0;      // of sdram: the opening and the closing of a row, pJ, kWorkEnergyRule
  int refresh_pj = 0;  // of sdram: a refresh, pJ, kWorkEnergyRule
};

// Of a part of the board's size for each kind, in the order of BankKind: greatest currents at the highest
// clock of the part. README.md here has the data sheets, the arithmetic, and what they lack.
inline constexpr std::array kBankEnergies = {
    BankEnergy{264, 7920},                  // zbt_pipelined: Samsung K7N163601M-10
    BankEnergy{264, 7920},                  // zbt_flow_through: no sheet; as zbt_pipelined
    BankEnergy{264, 7920},                  // sync_burst: Samsung K7A163600M-10
    BankEnergy{360, 539},                   // qdr: Samsung K7R161884B-16
    BankEnergy{181.5, 2772, 19866, 61215},  // sdram: Micron MT48LC4M32B2-7, revision G
};
static_assert(kBankEnergies.size() == kBankTraits.size());

// In pJ, below 2^63. The standby is rounded, halves up.
inline std::uint64_t energy_pj(const BankEnergy& bank, std::uint64_t time_ps, std::uint64_t accesses,
                               std::uint64_t rows_opened, std::uint64_t refreshes) {
  __extension__ using Wide = unsigned __int128;
  const Wide standby = Wide(std::llround(bank.standby_mw * 1000)) * time_ps;  // uW * ps: 10^-6 pJ
  const Wide work =
      Wide(bank.access_pj) * accesses + Wide(bank.row_pj) * rows_opened + Wide(bank.refresh_pj) * refreshes;
  return static_cast<std::uint64_t>((standby + 500'000) / 1'000'000 + work);
}

}  // namespace stereotlm::memory
