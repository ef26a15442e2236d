#include "sw/report/page_data/recording_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace stereotlm::report {
namespace {

// Reads a file in pieces of whole lines, because rows.csv of a long run is large.
template <typename Take>
void read_in_pieces(const std::filesystem::path& path, Take take) {
  constexpr std::size_t kPiece = 1U << 20U;
  std::ifstream file(path, std::ios::binary);
  std::string text;
  while (file) {
    const std::size_t rest = text.size();
    text.resize(rest + kPiece);
    file.read(text.data() + rest, kPiece);
    text.resize(rest + static_cast<std::size_t>(file.gcount()));
    const std::size_t lines = file ? text.rfind('\n') + 1 : text.size();
    take(std::string_view(text).substr(0, lines));
    text.erase(0, lines);
  }
}

}  // namespace

CsvLines::CsvLines(std::string path, const std::string& head)
    : path_(std::move(path)), head_(head.substr(0, head.find('\n'))) {
  split(head_);
  names_.assign(cells_.begin(), cells_.end());
}

void CsvLines::read(std::string_view text, const std::function<void()>& line) {
  while (!text.empty()) {
    const std::size_t size = text.find('\n');
    ++line_;
    if (size == std::string_view::npos) fail("must end with a newline");
    const std::string_view next = text.substr(0, size);
    text.remove_prefix(size + 1);
    if (line_ == 1) {
      if (next != head_) fail(fmt::format("must be the head '{}'", head_));
      continue;
    }
    split(next);
    if (cells_.size() != names_.size())
      fail(fmt::format("{} cells: must be {}, as in the head", cells_.size(), names_.size()));
    line();
  }
}

void CsvLines::finish(const platform::Audit& audit) const {
  if (line_ == 0) throw std::runtime_error(fmt::format("{}:1: missing: the head '{}'", path_, head_));
  if (!audit.failed().empty()) fail(audit.failed().front());
}

std::string_view CsvLines::cells(std::size_t first, std::size_t count) const {
  const std::string_view& last = cells_[first + count - 1];
  const char* const begin = cells_[first].data();
  return {begin, static_cast<std::size_t>(last.data() + last.size() - begin)};
}

std::uint64_t CsvLines::number(std::size_t column, std::uint64_t most, std::uint64_t least) const {
  const std::string_view cell = cells_[column];
  std::uint64_t number = 0;
  if (cell != "0") {  // most are
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
    if (error != std::errc() || end != cell.data() + cell.size() || cell.front() == '0') number = UINT64_MAX;
  }
  if (number < least || number > most)
    refuse(column, fmt::format("must be an integer of {}..{}", least, most));
  return number;
}

std::size_t CsvLines::index(std::size_t column, const std::vector<std::string>& names) const {
  const auto found = std::find(names.begin(), names.end(), cells_[column]);
  if (found == names.end()) refuse(column, fmt::format("must be one of {}", fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

void CsvLines::split(std::string_view line) {
  cells_.clear();
  std::size_t begin = 0;
  for (std::size_t end = 0; end < line.size(); ++end) {
    if (line[end] != ',') continue;
    cells_.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  cells_.push_back(line.substr(begin));
}

void CsvLines::refuse(std::size_t column, const std::string& rule) const {
  fail(fmt::format("{} = {}: {}", names_[column], cells_[column], rule));
}

void CsvLines::fail(const std::string& text) const {
  throw std::runtime_error(fmt::format("{}:{}: {}", path_, line_, text));
}

RecordingData::RecordingData(const platform::BoardConfig& board, bool camera,
                             const std::filesystem::path& folder)
    : folder_(folder), conflicts_(board, folder) {
  if (camera) timeline_.emplace(board, folder);
}

void RecordingData::add(const std::string& name, std::string_view text) {
  if (name == "rows.csv") conflicts_.add_rows(text);
  if (name == "conflicts.csv") conflicts_.add_tiles(text);
  if (timeline_ && name == "timeline.csv") timeline_->add_events(text);
  if (timeline_ && name == "latency.csv") timeline_->add_latencies(text);
}

bool RecordingData::add_folder(const platform::Statistics& statistics) {
  std::vector<std::string> names = {"rows.csv", "conflicts.csv"};
  if (timeline_) names.insert(names.end(), {"timeline.csv", "latency.csv"});
  if (!std::all_of(names.begin(), names.end(), [this](const std::string& name) {
        std::error_code ignored;
        return std::filesystem::is_regular_file(folder_ / name, ignored);
      }))
    return false;
  for (const std::string& name : names)
    read_in_pieces(folder_ / name, [&](std::string_view lines) { add(name, lines); });
  conflicts_.check(statistics);
  if (timeline_) timeline_->check(statistics);
  return true;
}

nlohmann::ordered_json RecordingData::json() const {
  nlohmann::ordered_json json = conflicts_.json();
  if (timeline_) json.update(timeline_->json());
  return json;
}

}  // namespace stereotlm::report
