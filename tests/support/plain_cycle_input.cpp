#include "tests/support/plain_cycle_input.h"

namespace stereotlm::test {

const char* name_of(PlainPort port) {
  static constexpr std::array<const char*, kPlainPortCount> kNames = {
      "left_lut", "right_lut", "left_pixel", "right_pixel", "result", "host"};
  return kNames[static_cast<std::size_t>(port)];
}

const char* name_of(PlainArbitration arbitration) {
  static constexpr std::array<const char*, 3> kNames = {"fixed_priority", "round_robin", "age"};
  return kNames[static_cast<std::size_t>(arbitration)];
}

PlainWord plain_word(const PlainParts& parts, int row, int word_of_row, int words_of_row) {
  const int stripes = static_cast<int>(parts.size());
  const PlainWord& part = parts[static_cast<std::size_t>(row % stripes)];
  return {part.bank, part.word + static_cast<std::uint64_t>(row / stripes * words_of_row + word_of_row)};
}

int plain_rows(std::size_t parts, std::size_t part, int height) {
  int rows = 0;
  for (auto row = static_cast<int>(part); row < height; row += static_cast<int>(parts)) ++rows;
  return rows;
}

PlainPlaces plain_places(const PlainCycleInput& input) {
  std::vector<std::uint64_t> used(input.banks.size());
  const auto place = [&](const PlainBuffer& buffer, int words_of_row) {
    PlainParts parts;
    for (const int bank : buffer.banks) {
      std::uint64_t& words = used[static_cast<std::size_t>(bank)];
      const int rows = plain_rows(buffer.banks.size(), parts.size(), input.height);
      parts.push_back({bank, words});
      words += static_cast<std::uint64_t>(rows * words_of_row);
    }
    return parts;
  };
  PlainPlaces places;
  for (const PlainBuffer& picture : input.left_image)
    places.left_image.push_back(place(picture, input.width / 4));
  for (const PlainBuffer& picture : input.right_image)
    places.right_image.push_back(place(picture, input.width / 4));
  for (const PlainBuffer& picture : input.disparity)
    places.disparity.push_back(place(picture, input.width / 4));
  if (input.left_lut) places.left_lut = place(*input.left_lut, input.width);
  if (input.right_lut)
    places.right_lut = input.joint_tables ? places.left_lut : place(*input.right_lut, input.width);
  return places;
}

int plain_read_latency(const PlainBank& bank) {
  if (bank.kind == PlainBankKind::kSdram) return bank.sdram.cas_latency;
  return bank.kind == PlainBankKind::kZbtFlowThrough ? 1 : 2;
}

}  // namespace stereotlm::test
