#include "sw/cli/options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "platform/config/board_keys.h"
#include "sw/cli/command.h"
#include "sw/files/aside.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/process/command.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"

// Implements options.h and command.h. Commands include these, because CLI11 takes long to compile.
namespace stereotlm::cli {

Rule required(const std::string& what) {
  return [what](const Option& option, process::Problems& problems) {
    const bool is_empty = option.text().empty() && option.texts().empty();
    if (!option.is_given() || is_empty) problems.add(fmt::format("{}: missing: {}", option.name(), what));
  };
}

Rule valid(const std::string& rule, const std::function<bool(const std::string&)>& is_valid) {
  return [rule, is_valid](const Option& option, process::Problems& problems) {
    if (option.is_given() && !is_valid(option.text()))
      problems.add(fmt::format("{} = {}: must be {}", option.name(), option.text(), rule));
  };
}

Rule one_of(const std::vector<std::string>& words) {
  return valid(platform::listed(words), [words](const std::string& text) {
    return std::find(words.begin(), words.end(), text) != words.end();
  });
}

Rule ends_in(const std::string& ending) {
  return [ending](const Option& option, process::Problems& problems) {
    if (option.is_given() && std::filesystem::path(option.text()).extension() != ending)
      problems.add(fmt::format("{} '{}': must end in {}", option.name(), option.text(), ending));
  };
}

Rule goes_with(const Option& other, const std::string& value) {
  return [&other, value](const Option& option, process::Problems& problems) {
    if (option.is_given() && !other.is_given())
      problems.add(fmt::format("{}: goes with {} {}", option.name(), other.name(), value));
  };
}

void Options::check_usage() {
  process::Problems problems;
  for (const auto& [option, rules] : rules_) {
    for (const Rule& rule : rules) rule(*option, problems);
  }
  check_together(problems);
  problems.check();
}

constexpr int kMostWords = 1'000'000;  // of a list; the parser takes a larger number for no limit

Option::Option(Options* of, const std::string& name, const std::string& value, const std::string& meaning,
               const std::vector<Rule>& rules, Takes takes)
    : name_(name.substr(0, name.find(','))) {
  if (of == nullptr) return;
  of->rules_.emplace_back(this, rules);
  CLI::App& command = *of->command_;
  if (value.empty()) {
    command.add_flag(name, is_given_, meaning);
    return;
  }
  CLI::Option* option = takes == Takes::kOne ? command.add_option(name, text_, meaning)
                                             : command.add_option(name, texts_, meaning);
  option->option_text(value)->each([this](const std::string& /*word*/) { is_given_ = true; });
  if (takes == Takes::kOneOrTwo) option->expected(1, 2);
  if (takes == Takes::kList) option->expected(1, kMostWords);
  // With extra arguments the parser would read "[a]" as a list, and "[]" as no value.
  if (!option->get_positional()) option->allow_extra_args(false);
}

CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::string& footer) {
  CLI::App* command = program.add_subcommand(name, description);
  command->footer(footer);
  command->add_flag_callback(
      "--quiet", [] { process::leave_out_notes(true); }, "Leave out notes and progress");
  return *command;
}

void when_parsed(CLI::App& command, const std::function<void()>& parsed) { command.callback(parsed); }

std::string paragraph(const std::string& head, std::size_t indent, const std::string& text) {
  std::string lines;
  std::string line = head;
  line.resize(std::max(indent, head.size()), ' ');
  bool has_word = false;
  std::istringstream words(text);
  for (std::string word; words >> word; has_word = true) {
    if (has_word && line.size() + 1 + word.size() > kTextColumns) {
      lines += line + '\n';
      line.assign(indent, ' ');
      has_word = false;
    }
    line += (has_word ? " " : "") + word;
  }
  return lines + line + '\n';
}

std::string with_coloured_words(std::string text, std::size_t from,
                                const std::vector<std::pair<std::string, process::Colour>>& words) {
  for (const auto& [word, colour] : words) {
    const std::size_t size = word.find('\n');  // a line ends without colour
    std::string coloured = process::coloured(STDOUT_FILENO, colour, word.substr(0, size));
    if (size != std::string::npos) coloured += word.substr(size);
    for (std::size_t at = from; (at = text.find(word, at)) != std::string::npos; at += coloured.size())
      text.replace(at, word.size(), coloured);
  }
  return text;
}

std::string json_text(const nlohmann::ordered_json& document) { return files::json_text(document, true); }

int interrupted(const std::string& what) {
  process::say("note", "interrupted: " + what);
  return kInterrupted;
}

bool write_out(const std::string& path, const files::FileKind& kind, const std::string& bytes) {
  process::attempt_or_refuse("--out ", [&] {
    files::OutputFile file(path, kind);
    file.write(bytes);
    file.complete();
    if (!process::interrupted()) file.commit();
  });
  return !process::interrupted();
}

process::CommandEnd draw(const std::string& script, const std::vector<std::string>& arguments) {
  runs::ProgressLine progress("the figures are drawn");
  return process::run_script(script, arguments, process::kPython, [&progress] { progress.show_time(); });
}

void check_temporary_folder(process::Problems& problems) {
  problems.attempt("", [] { const files::TemporaryFolder folder; });
}

}  // namespace stereotlm::cli
