#include "platform/config/board_draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include "platform/config/board_keys.h"
#include "platform/yaml/words.h"

namespace stereotlm::platform {
namespace {

[[noreturn]] void fail(std::string place, std::string text) {
  throw BoardError({{std::move(place), std::move(text)}});
}

// Adds to the map `own`, and to the maps in it, the entries that only `base` has. Some maps are taken whole
// from `own`.
void merge_into(YamlNode& own, const YamlNode& base, const std::string& path) {
  constexpr std::array<std::string_view, 2> kTakenWhole = {"ssram.banks", "matcher.filter"};
  const bool is_whole = std::find(kTakenWhole.begin(), kTakenWhole.end(), path) != kTakenWhole.end();
  if (!own.is_map() || !base.is_map() || is_whole) return;
  for (const YamlNode::Entry& entry : base.entries) {
    if (YamlNode::Entry* mine = own.find(entry.key.text)) {
      merge_into(mine->value, entry.value, below(path, entry.key.text));
    } else {
      own.entries.push_back(entry);
    }
  }
}

std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', begin)) {
    parts.push_back(path.substr(begin, dot - begin));
    begin = dot + 1;
  }
  parts.push_back(path.substr(begin));
  return parts;
}

// Puts the value into the tree at the path, and returns an empty text. If the tree cannot hold it there,
// returns the reason, and leaves the tree unchanged.
std::string put(YamlNode& tree, const std::string& path, YamlNode value, const Place& place) {
  YamlNode* at = &tree;
  YamlNode::Entry* entry = nullptr;
  std::string passed;
  for (const std::string& part : parts_of(path)) {
    if (!at->is_map()) return fmt::format("{} is not a map here; set it as a whole", passed);
    if (at->find(part) == nullptr) at->add(YamlNode::plain(part, place), YamlNode::map(place));
    entry = at->find(part);
    at = &entry->value;
    passed = below(passed, part);
  }
  entry->key.place = place;
  entry->value = std::move(value);
  return "";
}

void leave_out_missing(std::vector<Finding>& findings) {
  findings.erase(std::remove_if(findings.begin(), findings.end(),
                                [](const Finding& finding) { return !finding.missing.empty(); }),
                 findings.end());
}

// If most keys are missing, replaces the findings of missing keys by one that advises `extends`: the author
// of such a file usually wants to extend a preset.
void advise_extends(std::vector<Finding>& findings) {
  std::size_t missing = 0;
  for (const Finding& finding : findings) {
    if (!finding.missing.empty()) missing += required_count(finding.missing);
  }
  if (missing == 0) return;
  const std::size_t all = required_count("");
  if (2 * missing <= all) return;
  leave_out_missing(findings);
  const std::string text = fmt::format(
      "{} of the {} keys of a board are missing: begin the file with `extends: {}`, which supplies them",
      missing, all, preset_names().front());
  findings.insert(findings.begin(), Finding({Place::kBoard, 1, 1}, text));
}

std::string text_of(const std::string& path, const YamlNode& value, const std::string& rule) {
  return fmt::format("{} = {}: {}", path, short_text(value), rule);
}

std::string lines_of(const std::vector<Diagnostic>& diagnostics, const std::string& note) {
  std::vector<std::string> lines;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (lines.size() == BoardError::kMostLines) {
      const std::size_t more = diagnostics.size() - lines.size();
      lines.push_back(fmt::format("and {} error{} more", more, more == 1 ? "" : "s"));
      break;
    }
    lines.push_back(diagnostic.place + ": " + diagnostic.text);
  }
  if (!note.empty()) lines.push_back(note);
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace

BoardError::BoardError(std::vector<Diagnostic> diagnostics, const std::string& note)
    : std::runtime_error(lines_of(diagnostics, note)), diagnostics_(std::move(diagnostics)) {}

std::string read_text_file(const std::string& path, const std::string& kind) {
  const auto refuse = [&path](const std::string& rule) { throw BoardError({{path, rule}}); };
  constexpr std::size_t kLargestBytes = std::size_t{1} << 20;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) refuse("a folder, not a " + kind);
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
  std::string text(kLargestBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) refuse("cannot be read: input error");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLargestBytes) refuse(fmt::format("larger than {} bytes: not a {}", kLargestBytes, kind));
  return text;
}

BoardConfig load_board(const std::string& board, const std::vector<std::string>& sets) {
  BoardDraft draft(board);
  for (const std::string& set : sets) draft.set(set);
  return draft.read();
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.emplace_back(preset.name);
  return names;
}

std::string_view preset_text(std::string_view name) {
  for (const Preset& preset : presets()) {
    if (preset.name == name) return preset.text;
  }
  throw std::out_of_range(fmt::format("{}: not a preset", name));
}

std::string path_problem(const std::string& path) {
  if (path == "extends") return "extends can only be given in the board file";
  std::string schema;
  for (const std::string& part : parts_of(path)) {
    const std::vector<std::string> known = child_keys(schema);
    if (known.empty()) return fmt::format("{} has no keys below it", schema);
    const bool is_bank = schema == "ssram.banks" && !part.empty();
    if (!is_bank && std::find(known.begin(), known.end(), part) == known.end()) {
      return unknown_key_text(path);
    }
    schema = below(schema, is_bank ? "NAME" : part);
  }
  return "";
}

bool is_board_file(const std::string& board) {
  const std::string_view ending = ".yaml";
  return board.find('/') != std::string::npos ||
         (board.size() >= ending.size() && board.substr(board.size() - ending.size()) == ending);
}

BoardDraft::BoardDraft(const std::string& board, const std::string* text) {
  std::error_code none;
  const std::vector<std::string> names = preset_names();
  std::string preset;
  if (text != nullptr) {
    board_name_ = board;
    file_text_ = *text;
  } else if (std::find(names.begin(), names.end(), board) != names.end()) {
    board_name_ = "preset " + board;
    preset = preset_text(board);
  } else if (const std::filesystem::path inside = std::filesystem::path(board) / "config.yaml";
             std::filesystem::is_regular_file(inside, none)) {
    fail(board, fmt::format("a folder, not a board file; its board is {}", inside.string()));
  } else if (is_board_file(board)) {
    board_name_ = board;
    file_text_ = read_text_file(board, "board file");
  } else {
    fail(board.empty() ? "(empty)" : board,
         fmt::format("not a preset, and not a path, which has a / or ends in .yaml{}; presets: {}",
                     nearest_text(board, names), listed(names)));
  }
  try {
    tree_ = parse_yaml(preset.empty() ? file_text_ : preset, Place::kBoard);
  } catch (const YamlError& error) {
    fail(place_text(error.place), error.what());
  }
  resolve_extends();
}

// Does not handle errors, because the presets are files of this project.
BoardDraft BoardDraft::of_preset(std::string_view name) {
  BoardDraft draft;
  draft.tree_ = parse_yaml(std::string(preset_text(name)), Place::kPreset);
  draft.resolve_extends();
  return draft;
}

// Removes `extends` from the tree, and adds the values of the preset that it names.
void BoardDraft::resolve_extends() {
  const auto is_extends = [](const YamlNode::Entry& entry) { return entry.key.is("extends"); };
  const auto report = [this](const Place& place, const YamlNode& value, const std::string& rule) {
    findings_.emplace_back(place, text_of("extends", value, rule));
  };
  std::optional<YamlNode> base;
  for (std::size_t i = 0; i < tree_.entries.size(); ++i) {
    const YamlNode::Entry& entry = tree_.entries[i];
    if (!is_extends(entry)) continue;
    if (std::exchange(has_extends_, true)) {
      report(entry.key.place, entry.value, "repeated key");
      continue;
    }
    if (i > 0) report(entry.key.place, entry.value, "extends must be the first key");
    const YamlNode& value = entry.value;
    const std::vector<std::string> names = preset_names();
    const bool is_known =
        value.is_scalar() && std::find(names.begin(), names.end(), value.text) != names.end();
    const std::string& misuse = entry.key.misuse.empty() ? value.misuse : entry.key.misuse;
    if (!misuse.empty()) {
      report(value.place, value, misuse);
    } else if (!is_known) {
      report(value.place, value,
             fmt::format("not a preset{}; presets: {}", nearest_text(value.text, names), listed(names)));
    }
    if (is_known) base = of_preset(value.text).tree_;
    is_whole_ = is_known;
  }
  tree_.entries.erase(std::remove_if(tree_.entries.begin(), tree_.entries.end(), is_extends),
                      tree_.entries.end());
  if (base) merge_into(tree_, *base, "");
}

void BoardDraft::set(const std::string& assignment) {
  if (!tree_.is_map()) return;  // read() reports it
  const std::size_t equals = assignment.find('=');
  const std::string path = assignment.substr(0, equals);
  const std::string name = "--set " + path;
  const Place place = next_place();
  const bool is_repeated = std::any_of(sources_.begin(), sources_.end(), [&](const Source& source) {
    return !source.has_lines && source.name == name;
  });
  sources_.push_back({name, false});
  const std::string text = equals == std::string::npos ? "(nothing)" : assignment.substr(equals + 1);
  const auto report = [&](const std::string& rule) {
    findings_.emplace_back(place, text_of(path, YamlNode::plain(text), rule));
  };
  if (equals == std::string::npos) return report("--set needs path=value");
  if (const std::string problem = path_problem(path); !problem.empty()) return report(problem);
  if (is_repeated) return report("the same path was set before");
  try {
    const std::string problem = put(tree_, path, parse_flow_value(text, place.source), place);
    if (!problem.empty()) report(problem);
  } catch (const YamlError& error) {
    report(error.what());
  }
}

void BoardDraft::replace(const std::string& path, YamlNode value, const std::string& file) {
  if (!tree_.is_map()) return;  // read() reports it
  const int source = next_place().source;
  for_each_node(value, [source](YamlNode& node) { node.place.source = source; });
  sources_.push_back({file, true});
  std::string problem = path_problem(path);
  if (problem.empty()) problem = put(tree_, path, value, value.place);
  if (!problem.empty()) findings_.emplace_back(value.place, text_of(path, value, problem));
}

// Reads a tree that holds only this value. A missing key is a problem of the value only if the key belongs
// inside the value.
std::vector<Diagnostic> BoardDraft::problems_of(const std::string& path, const YamlNode& value,
                                                const std::string& file) const {
  std::vector<Finding> findings;
  std::string problem = path_problem(path);
  YamlNode tree = tree_;
  if (problem.empty()) problem = put(tree, path, value, value.place);
  if (problem.empty()) {
    YamlNode alone = YamlNode::map();
    put(alone, path, value, value.place);
    read_board(alone, findings);
  } else {
    findings.emplace_back(value.place, text_of(path, value, problem));
  }
  std::vector<Diagnostic> problems;
  for (Finding& finding : findings) {
    const bool is_outside = !is_below(finding.missing, path);
    if (!finding.missing.empty() && (is_outside || finding.is_between_keys)) continue;
    problems.push_back({fmt::format("{}:{}:{}", file, finding.place.line, finding.place.column),
                        std::move(finding.text), false});
  }
  return problems;
}

BoardConfig BoardDraft::read() const {
  Reading reading = read_with_problems();
  if (!reading.problems.empty()) throw BoardError(std::move(reading.problems));
  return std::move(reading.board);
}

BoardDraft::Reading BoardDraft::read_with_problems() const {
  std::vector<Finding> findings = findings_;
  Reading reading{read_board(tree_, findings), {}};
  if (!is_whole_) leave_out_missing(findings);
  if (!has_extends_) advise_extends(findings);
  std::stable_sort(findings.begin(), findings.end(), [](const Finding& a, const Finding& b) {
    return std::tie(a.place.source, a.place.line, a.place.column) <
           std::tie(b.place.source, b.place.line, b.place.column);
  });
  // Two elements of a list may have the same problem, and within `--set` the same place.
  std::set<std::pair<std::string, std::string>> reported;
  reading.problems.reserve(findings.size());
  for (Finding& finding : findings) {
    std::string place = place_text(finding.place);
    if (!reported.emplace(place, finding.text).second) continue;
    reading.problems.push_back(
        {std::move(place), std::move(finding.text), finding.is_between_keys, !finding.missing.empty()});
  }
  return reading;
}

std::string BoardDraft::place_text(const Place& place) const {
  std::string name = place.source == Place::kBoard ? board_name_ : "preset";
  if (place.source >= Place::kFirstSet) {
    const Source& source = sources_[static_cast<std::size_t>(place.source - Place::kFirstSet)];
    if (!source.has_lines) return source.name;
    name = source.name;
  }
  return fmt::format("{}:{}:{}", name, place.line, place.column);
}

}  // namespace stereotlm::platform
