#include "tests/support/plain_conflicts.h"

#include <algorithm>
#include <sstream>

namespace stereotlm::test {
namespace {

// Of who waits and of who is to blame, by their numbers.
std::vector<std::string> names_of(const PlainCycleInput& input) {
  std::vector<std::string> names = plain_names(input.lanes);
  const auto host = std::find(names.begin(), names.end(), "host");
  *host = "host read-back";
  names.insert(host, {"host capture", "host upload"});
  return names;
}

std::string column_of(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char letter) { return letter == ' ' || letter == '-'; }, '_');
  return "," + name + "_stall_cycles";
}

std::string rows_of(const PlainCycleInput& input, std::size_t first_strip, std::size_t strips) {
  const auto rows = static_cast<std::size_t>(input.rows);
  const std::size_t end = std::min((first_strip + strips) * rows, static_cast<std::size_t>(input.height));
  return std::to_string(first_strip * rows) + "," + std::to_string(end - 1);
}

__extension__ typedef __int128 Wide;

// The table of 9.1.
PlainEnergy typical(PlainBankKind kind) {
  if (kind == PlainBankKind::kQdr) return {360'000, 539, 0, 0};
  if (kind == PlainBankKind::kSdram) return {181'500, 2772, 19866, 61215};
  return {264'000, 7920, 0, 0};
}

}  // namespace

std::string plain_rows_csv(const PlainCycleInput& input, const std::vector<std::vector<PlainStrip>>& frames) {
  std::ostringstream text;
  text << "frame,first_row,last_row,cycles";
  for (const std::string& name : names_of(input)) {
    if (name == "turnaround") break;
    text << column_of(name);
  }
  for (std::size_t bank = 0; bank < input.banks.size(); ++bank) {
    for (const char* kind : {"core", "capture", "upload", "read_back"})
      text << ",bank" << bank << "_" << kind << "_accesses";
  }
  text << "\n";
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    for (std::size_t number = 0; number < frames[frame].size(); ++number) {
      const PlainStrip& strip = frames[frame][number];
      text << frame << "," << (number == 0 ? "," : rows_of(input, number - 1, 1)) << "," << strip.cycles;
      for (const std::uint64_t lost : strip.lost) text << "," << lost;
      for (const auto& bank : strip.accesses) {
        for (const std::uint64_t accesses : bank) text << "," << accesses;
      }
      text << "\n";
    }
  }
  return text.str();
}

std::string plain_conflicts_csv(const PlainCycleInput& input, const std::vector<PlainTile>& tiles,
                                std::size_t strips, std::size_t groups) {
  const auto groups_of_strip = static_cast<std::size_t>(input.width / 4);
  const std::size_t all_strips = (tiles.size() - 1) / groups_of_strip;
  std::ostringstream text;
  text << "first_row,last_row,first_column,last_column,tile_cycles,port,bank,by,cycles\n";
  const std::vector<std::string> names = names_of(input);
  const auto add = [&text, &names](const std::string& place, const PlainTile& tile) {
    for (const auto& [loss, cycles] : tile.lost) {
      text << place << "," << tile.cycles << "," << names[loss.waiter] << ",bank" << loss.bank << ","
           << names[loss.by] << "," << cycles << "\n";
    }
  };
  add(",,,", tiles.front());
  for (std::size_t first_strip = 0; first_strip < all_strips; first_strip += strips) {
    for (std::size_t first_group = 0; first_group < groups_of_strip; first_group += groups) {
      PlainTile sum;
      const std::size_t end_strip = std::min(first_strip + strips, all_strips);
      const std::size_t end_group = std::min(first_group + groups, groups_of_strip);
      for (std::size_t strip = first_strip; strip < end_strip; ++strip) {
        for (std::size_t group = first_group; group < end_group; ++group) {
          const PlainTile& tile = tiles[1 + strip * groups_of_strip + group];
          sum.cycles += tile.cycles;
          for (const auto& [loss, cycles] : tile.lost) sum.lost[loss] += cycles;
        }
      }
      add(rows_of(input, first_strip, strips) + "," + std::to_string(4 * first_group) + "," +
              std::to_string(4 * end_group - 1),
          sum);
    }
  }
  return text.str();
}

std::string plain_energy(const PlainCycleInput& input, const PlainCycleResult& result,
                         const std::vector<PlainBankWork>& work, PlainTime time_ps) {
  std::ostringstream text;
  std::uint64_t sum = 0;
  for (std::size_t bank = 0; bank < input.banks.size(); ++bank) {
    if (!result.used_banks[bank]) continue;
    const PlainEnergy energy = input.banks[bank].energy.value_or(typical(input.banks[bank].kind));
    const auto& [accesses, rows_opened, refreshes] = work[bank];
    const Wide standby = Wide{energy.standby_uw} * static_cast<Wide>(time_ps);  // 10^-18 J
    const auto pj = static_cast<std::uint64_t>(
        standby / 1'000'000 + (standby % 1'000'000 >= 500'000 ? 1 : 0) + Wide{energy.access_pj} * accesses +
        Wide{energy.row_pj} * rows_opened + Wide{energy.refresh_pj} * refreshes);
    sum += pj;
    text << "bank" << bank << " " << accesses << " " << rows_opened << " " << refreshes << " " << pj << "\n";
  }
  std::size_t buffer = 0;
  for (const char* name : {"left_image", "right_image", "disparity", "left_lut", "right_lut"})
    text << name << " " << 4 * result.buffer_accesses[buffer++] << "\n";
  text << "all " << time_ps << " " << sum << "\n";
  return text.str();
}

std::string differing_lines(const std::string& expected, const std::string& found) {
  constexpr int kMost = 20;
  std::istringstream expected_lines(expected);
  std::istringstream found_lines(found);
  std::string text;
  for (int differ = 0; differ < kMost;) {
    std::string a;
    std::string b;
    const bool has_a = static_cast<bool>(std::getline(expected_lines, a));
    const bool has_b = static_cast<bool>(std::getline(found_lines, b));
    if (!has_a && !has_b) break;
    if (a == b) continue;
    ++differ;
    text += "plain: " + a + "\nmodel: " + b + "\n";
  }
  return text;
}

}  // namespace stereotlm::test
