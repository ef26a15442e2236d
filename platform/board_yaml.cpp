#include "platform/board_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <tuple>
#include <utility>

#include "platform/board_keys.h"
#include "platform/board_reader.h"
#include "platform/boards/presets.h"
#include "platform/yaml_tree.h"

namespace stereotlm::platform {
namespace {

std::string all_lines(const std::vector<Diagnostic>& diagnostics) {
  std::string lines;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!lines.empty()) lines += '\n';
    lines += diagnostic.place + ": " + diagnostic.text;
  }
  return lines;
}

[[noreturn]] void fail(std::string place, std::string text) {
  throw BoardError({{std::move(place), std::move(text)}});
}

// A board, and what turned up on the way to it.
struct Draft {
  std::string board_name;              // of the file or preset, for messages
  std::vector<std::string> set_paths;  // in order
  YamlNode tree;
  bool is_whole = true;  // false: the preset that it extends could not be found
  std::vector<Finding> findings;

  std::string text_of(const Place& place) const {
    if (place.source >= Place::kFirstSet) {
      return "--set " + set_paths[static_cast<std::size_t>(place.source - Place::kFirstSet)];
    }
    const char* name = place.source == Place::kBoard ? board_name.c_str() : "preset";
    return fmt::format("{}:{}:{}", name, place.line, place.column);
  }
};

std::string read_file(const std::string& path) {
  constexpr std::size_t kLargestBytes = std::size_t{1} << 20;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) fail(path, "a folder, not a board file");
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, fmt::format("cannot be read: {}", std::strerror(errno)));
  std::string text(kLargestBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) fail(path, "cannot be read: input error");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLargestBytes)
    fail(path, fmt::format("larger than {} bytes: not a board file", kLargestBytes));
  return text;
}

// Puts what `base` has and `own` leaves out into `own`, map by map.
void merge_into(YamlNode& own, const YamlNode& base, const std::string& path) {
  constexpr std::array<std::string_view, 2> kTakenWhole = {"ssram.banks", "matcher.filter"};
  const bool is_whole = std::find(kTakenWhole.begin(), kTakenWhole.end(), path) != kTakenWhole.end();
  if (!own.is_map() || !base.is_map() || is_whole) return;
  for (const YamlNode::Entry& entry : base.entries) {
    if (YamlNode::Entry* mine = own.find(entry.key.text)) {
      merge_into(mine->value, entry.value, path.empty() ? entry.key.text : path + '.' + entry.key.text);
    } else {
      own.entries.push_back(entry);
    }
  }
}

YamlNode preset_tree(std::string_view name);

// Takes `extends` out of the tree and puts in what the preset supplies.
void resolve_extends(Draft& draft) {
  YamlNode& tree = draft.tree;
  const auto is_extends = [](const YamlNode::Entry& entry) {
    return entry.key.is_scalar() && entry.key.text == "extends";
  };
  const auto report = [&draft](const Place& place, const YamlNode& value, const std::string& rule) {
    draft.findings.push_back({place, fmt::format("extends = {}: {}", short_text(value), rule)});
  };
  std::optional<YamlNode> base;
  for (std::size_t i = 0; i < tree.entries.size(); ++i) {
    const YamlNode::Entry& entry = tree.entries[i];
    if (!is_extends(entry)) continue;
    if (base || !draft.is_whole) {
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
             fmt::format("not a preset; nearest: {}; presets: {}",
                         nearest_word(value.is_scalar() ? value.text : "", names), listed(names)));
    }
    if (is_known) base = preset_tree(value.text);
    draft.is_whole = is_known;
  }
  tree.entries.erase(std::remove_if(tree.entries.begin(), tree.entries.end(), is_extends),
                     tree.entries.end());
  if (base) merge_into(tree, *base, "");
}

// A preset with all that it extends. The presets are files of this project, without errors.
YamlNode preset_tree(std::string_view name) {
  Draft draft;
  draft.tree = parse_yaml(std::string(preset_text(name)), Place::kPreset);
  resolve_extends(draft);
  return std::move(draft.tree);
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

// What is wrong with the path of a `--set`; empty if the schema has it.
std::string path_problem(const std::string& path) {
  if (path == "extends") return "extends stands in the board file";
  std::string schema;
  for (const std::string& part : parts_of(path)) {
    const std::vector<std::string> known = child_keys(schema);
    if (known.empty()) return fmt::format("{} has no keys below it", schema);
    const bool is_bank = schema == "ssram.banks" && !part.empty();
    if (!is_bank && std::find(known.begin(), known.end(), part) == known.end()) {
      return "unknown key; nearest known key: " + nearest_path(path);
    }
    schema += (schema.empty() ? "" : ".") + (is_bank ? "NAME" : part);
  }
  return "";
}

// Puts the value at the path into the tree. Returns the path of what is in the way because it is not a map;
// empty if nothing is.
std::string put(YamlNode& tree, const std::string& path, YamlNode value, const Place& place) {
  YamlNode* at = &tree;
  YamlNode::Entry* entry = nullptr;
  std::string passed;
  for (const std::string& part : parts_of(path)) {
    if (!at->is_map()) return passed;
    entry = at->find(part);
    if (entry == nullptr) {
      YamlNode key;
      key.kind = YamlNode::Kind::kScalar;
      key.text = part;
      key.place = place;
      YamlNode map;
      map.kind = YamlNode::Kind::kMap;
      map.place = place;
      at->entries.push_back({std::move(key), std::move(map)});
      entry = &at->entries.back();
    }
    at = &entry->value;
    passed += (passed.empty() ? "" : ".") + part;
  }
  entry->key.place = place;
  entry->value = std::move(value);
  return "";
}

void apply_set(Draft& draft, const std::string& set) {
  const std::size_t equals = set.find('=');
  const std::string path = set.substr(0, equals);
  const bool is_repeated =
      std::find(draft.set_paths.begin(), draft.set_paths.end(), path) != draft.set_paths.end();
  const Place place{Place::kFirstSet + static_cast<int>(draft.set_paths.size()), 1, 1};
  draft.set_paths.push_back(path);
  const auto report = [&](const std::string& rule) {
    YamlNode value;
    value.kind = YamlNode::Kind::kScalar;
    value.text = equals == std::string::npos ? "(nothing)" : set.substr(equals + 1);
    draft.findings.push_back({place, fmt::format("{} = {}: {}", path, short_text(value), rule)});
  };
  if (equals == std::string::npos) return report("--set needs path=value");
  if (const std::string problem = path_problem(path); !problem.empty()) return report(problem);
  if (is_repeated) return report("the same path was set before");
  try {
    const std::string way =
        put(draft.tree, path, parse_flow_value(set.substr(equals + 1), place.source), place);
    if (!way.empty()) report(fmt::format("{} is not a map here; set it as a whole", way));
  } catch (const YamlError& error) {
    report(error.what());
  }
}

[[noreturn]] void fail_with_findings(Draft& draft) {
  std::stable_sort(draft.findings.begin(), draft.findings.end(), [](const Finding& a, const Finding& b) {
    return std::tie(a.place.source, a.place.line, a.place.column) <
           std::tie(b.place.source, b.place.line, b.place.column);
  });
  std::vector<Diagnostic> diagnostics;
  for (Finding& finding : draft.findings) {
    diagnostics.push_back({draft.text_of(finding.place), std::move(finding.text)});
  }
  throw BoardError(std::move(diagnostics));
}

Draft open_draft(const std::string& board) {
  Draft draft;
  const std::string ending = ".yaml";
  const bool is_path = board.find('/') != std::string::npos ||
                       (board.size() >= ending.size() &&
                        board.compare(board.size() - ending.size(), ending.size(), ending) == 0);
  std::string text;
  if (is_path) {
    draft.board_name = board;
    text = read_file(board);
  } else {
    const std::vector<std::string> names = preset_names();
    if (std::find(names.begin(), names.end(), board) == names.end()) {
      fail(board.empty() ? "(empty)" : board,
           fmt::format(
               "not a preset, and not a path, which has a / or ends in .yaml; nearest: {}; presets: {}",
               nearest_word(board, names), listed(names)));
    }
    draft.board_name = "preset " + board;
    text = preset_text(board);
  }
  try {
    draft.tree = parse_yaml(text, Place::kBoard);
  } catch (const YamlError& error) {
    fail(draft.text_of(error.place), error.what());
  }
  return draft;
}

}  // namespace

BoardError::BoardError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(all_lines(diagnostics)), diagnostics_(std::move(diagnostics)) {}

BoardConfig load_board(const std::string& board, const std::vector<std::string>& sets) {
  Draft draft = open_draft(board);
  resolve_extends(draft);
  if (draft.tree.is_map()) {
    for (const std::string& set : sets) apply_set(draft, set);
  }
  BoardConfig config = read_board(draft.tree, draft.is_whole, draft.findings);
  if (!draft.findings.empty()) fail_with_findings(draft);
  return config;
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

std::vector<KeyInfo> keys() {
  std::vector<KeyInfo> all = {
      {"extends", "the preset that supplies the keys that the file leaves out; optional, the first key", "",
       listed(preset_names())}};
  for (const Key& key : board_keys()) all.push_back({key.path, key.meaning, key.unit, key.rule_text});
  return all;
}

}  // namespace stereotlm::platform
