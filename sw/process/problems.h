#pragma once

#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/config/board_yaml.h"

namespace stereotlm::process {

// Thrown to refuse a command before it has done anything (exit status 2). Holds the lines for standard error.
class Refused : public std::exception {
 public:
  Refused(std::vector<std::string> lines, std::vector<platform::Diagnostic> problems)
      : lines_(std::move(lines)), problems_(std::move(problems)) {}
  const std::vector<std::string>& lines() const { return lines_; }
  const std::vector<platform::Diagnostic>& problems() const { return problems_; }
  const char* what() const noexcept override { return "the command is refused"; }

 private:
  std::vector<std::string> lines_;
  std::vector<platform::Diagnostic> problems_;
};

// What has failed, as users are told. The texts of the C++ library name its own functions.
inline std::string text_of(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return "out of memory";
  const auto* const of_file = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
  if (of_file == nullptr) return error.what();
  const std::string path = of_file->path1().empty() ? "." : of_file->path1().string();
  return "'" + path + "': " + of_file->code().message();
}

// Collects everything that is wrong with a command, so that one message can report it all.
class Problems {
 public:
  void add(const std::string& text) {
    lines_.push_back("stereotlm: error: " + text);
    diagnostics_.push_back({"command line", text});
  }
  // The lines of a BoardError name the file and the position; they are added as they are.
  void add(const platform::BoardError& error) {
    lines_.emplace_back(error.what());
    diagnostics_.insert(diagnostics_.end(), error.diagnostics().begin(), error.diagnostics().end());
  }

  // Calls `step`, and adds what it throws, behind the prefix. Returns whether it throws nothing.
  template <typename Step>
  bool attempt(const std::string& prefix, const Step& step) {
    try {
      step();
      return true;
    } catch (const platform::BoardError& error) {
      add(error);
    } catch (const std::bad_alloc&) {  // no problem of the command
      throw;
    } catch (const std::exception& error) {
      add(prefix + text_of(error));
    }
    return false;
  }

  // Adds a hint about the problems.
  void add_note(const std::string& text) { lines_.push_back("stereotlm: note: " + text); }
  bool empty() const { return lines_.empty(); }
  // All problems, without limit of their number. Those of no board have the place "command line".
  const std::vector<platform::Diagnostic>& diagnostics() const { return diagnostics_; }
  // All lines, separated by semicolons, without the name of the program.
  std::string in_one_line() const {
    constexpr std::string_view kPrefix = "stereotlm: error: ";
    std::string text;
    for (const std::string& line : lines_) {
      if (!text.empty()) text += "; ";
      text += line.compare(0, kPrefix.size(), kPrefix) == 0 ? line.substr(kPrefix.size()) : line;
    }
    return text;
  }

  // Throws Refused if there are any problems.
  void check() const {
    if (!lines_.empty()) throw Refused(lines_, diagnostics_);
  }

 private:
  std::vector<std::string> lines_;
  std::vector<platform::Diagnostic> diagnostics_;
};

// Refuses the command because of one problem.
[[noreturn]] inline void refuse(const std::string& text) {
  throw Refused({"stereotlm: error: " + text}, {{"command line", text}});
}

// Calls `step`, and refuses the command if it throws, with the message behind the prefix.
template <typename Step>
void attempt_or_refuse(const std::string& prefix, const Step& step) {
  Problems problems;
  problems.attempt(prefix, step);
  problems.check();
}

}  // namespace stereotlm::process
