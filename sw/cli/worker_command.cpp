#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <system_error>
#include <systemc>

#include "sw/cli/command.h"
#include "sw/files/text_forms.h"
#include "sw/process/child.h"
#include "sw/process/client.h"
#include "sw/process/problems.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;
using process::Array;

constexpr const char* kWorkerFooter =
    "Requests come by standard input, answers leave by standard output: lines of JSON, and the pixels of\n"
    "pictures behind them. The Python module stereotlm uses this protocol: sw/python/README.md.";

struct Request {
  std::vector<std::string> arguments;
  std::filesystem::path folder;  // to which paths are relative
  std::vector<Array> arrays;
};

// What is not UTF-8 is replaced.
std::string line_of(const Json& document) {
  return document.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

// What the process that executes commands tells the worker: this byte, then what the client is to get.
constexpr char kBegins = 'b';   // a request
constexpr char kRead = 'r';     // the request is read whole
constexpr char kPart = 'p';     // a part of its answer
constexpr char kEnds = 'e';     // the last part
constexpr char kWasLast = 'l';  // there is no further request

// Tells the worker what a command says.
class Answer : public process::Client {
 public:
  Answer(const process::Child::Tell& tell, const std::vector<Array>& given) : tell_(tell), given_(given) {}

  const Array* given(std::string_view name) override {
    asked_for_.emplace(name);
    const auto found =
        std::find_if(given_.begin(), given_.end(), [&](const Array& array) { return array.name == name; });
    return found == given_.end() ? nullptr : &*found;
  }
  void check_given() const override {
    process::Problems problems;
    for (const Array& array : given_) {
      if (asked_for_.count(array.name) == 0)
        problems.add(fmt::format("array {}: the command takes no array of this name", array.name));
    }
    problems.check();
  }
  void print(std::string_view text) override { output_ += text; }
  void say(const std::string& line) override { tell(kPart, {{"message", line}}); }
  void send(const Array& array) override {
    tell(kPart, {{"array", array.name}, {"shape", array.shape}}, array.bytes);
  }
  void progress(std::uint64_t done, std::uint64_t of, const std::string& text) override {
    tell(kPart, {{"done", done}, {"of", of}, {"progress", text}});
  }
  void refuse(const std::vector<platform::Diagnostic>& problems) override {
    for (const platform::Diagnostic& problem : problems) problems_.push_back(problem_document(problem));
  }
  void end(int status) { tell(kEnds, {{"status", status}, {"output", output_}, {"problems", problems_}}); }

 private:
  void tell(char what, const Json& document, const std::string& bytes = "") {
    tell_(what + line_of(document) + bytes);
  }

  const process::Child::Tell& tell_;
  const std::vector<Array>& given_;
  std::set<std::string> asked_for_;  // names
  std::string output_;
  Json problems_ = Json::array();
};

// The value of a key of a request. Throws std::runtime_error if it is missing or of another type.
template <typename Value>
Value value_of(const Json& object, const char* key, const char* rule) {
  try {
    return object.at(key).get<Value>();
  } catch (const Json::exception& /*error*/) {
    const std::string found = object.contains(key) ? " = " + object[key].dump() : ": missing";
    throw std::runtime_error(fmt::format("{}{}: must be {}", key, found, rule));
  }
}

// An array without its bytes, and their number. Throws std::runtime_error.
std::pair<Array, std::size_t> array_of(const Json& given) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 32U;
  Array array = {value_of<std::string>(given, "name", "a text"), {}, ""};
  std::uint64_t bytes = 1;
  for (const Json& length : value_of<std::vector<Json>>(given, "shape", "a list of integers")) {
    const auto refuse = [&](const std::string& rule) {
      throw std::runtime_error(
          fmt::format("array {}: shape = {}: must {}", array.name, given["shape"].dump(), rule));
    };
    if (!length.is_number_unsigned()) refuse("be a list of integers, 0 or more");
    array.shape.push_back(length);
    if (array.shape.back() > kMostBytes / std::max<std::uint64_t>(bytes, 1))
      refuse(fmt::format("have at most {} bytes", kMostBytes));
    bytes *= array.shape.back();
  }
  return {array, bytes};
}

// Reads a line, and no byte behind it. The last one needs no newline. Returns false at the end of the file.
bool read_line(int from, std::string& line) {
  for (char byte = 0; process::read_all(from, &byte, 1);) {
    if (byte == '\n') return true;
    line += byte;
  }
  return !line.empty();
}

// The bytes whose values are the codes of the characters. Throws std::runtime_error for a code above 255.
std::string bytes_of_codes(const std::string& utf8) {
  std::string bytes;
  for (const char each : utf8) {
    const auto code = static_cast<unsigned char>(each);
    if (code > 0xC3U) throw std::runtime_error("encoding = latin-1: characters must be U+0000 to U+00FF");
    if (code >= 0x80U && code < 0xC0U)  // the second byte of a character
      bytes.back() = static_cast<char>((bytes.back() & 3) << 6 | (code & 0x3F));
    else
      bytes += each;
  }
  return bytes;
}

// Reads the arrays behind the line, too. Throws std::runtime_error if this is no request.
Request request_of(const std::string& line, int from) {
  const Json document = files::parse_json(line);
  if (!document.is_object()) throw std::runtime_error("must be a JSON object");
  Request request;
  const auto text_of = [&](const char* key, const char* missing) {
    return document.contains(key) ? value_of<std::string>(document, key, "a text") : missing;
  };
  request.arguments = value_of<std::vector<std::string>>(document, "arguments", "a list of texts");
  std::string folder = text_of("folder", "");
  const std::string encoding = text_of("encoding", "utf-8");
  if (encoding == "latin-1") {
    for (std::string& argument : request.arguments) argument = bytes_of_codes(argument);
    folder = bytes_of_codes(folder);
  } else if (encoding != "utf-8") {
    throw std::runtime_error(fmt::format("encoding = {}: must be utf-8 or latin-1", encoding));
  }
  static std::error_code error;  // the folder may have been removed
  static const std::filesystem::path of_worker = std::filesystem::current_path(error);
  request.folder = of_worker / folder;
  if (!document.contains("arrays")) return request;
  for (const Json& given : value_of<std::vector<Json>>(document, "arrays", "a list of arrays")) {
    auto [array, bytes] = array_of(given);
    for (const Array& other : request.arrays) {
      if (other.name == array.name) throw std::runtime_error(fmt::format("array {}: sent twice", array.name));
    }
    array.bytes.resize(bytes);
    if (!process::read_all(from, array.bytes.data(), bytes))
      throw std::runtime_error(fmt::format("array {}: ends early", array.name));
    request.arrays.push_back(std::move(array));
  }
  return request;
}

// Reads a request and executes it. Returns whether the process can execute another one.
bool serve_one(const process::Child::Tell& tell) {
  std::string line;
  if (!read_line(STDIN_FILENO, line)) {
    tell({kWasLast});
    return false;
  }
  tell({kBegins});
  Request request;
  Answer answer(tell, request.arrays);
  process::client = &answer;
  process::leave_out_notes(false);
  try {
    request = request_of(line, STDIN_FILENO);
  } catch (const std::runtime_error& error) {  // where the next request begins is not known
    process::say("error", fmt::format("a request of the worker: {}", error.what()));
    answer.end(kRefused);
    tell({kWasLast});
    return false;
  }
  tell({kRead});
  std::vector<const char*> words = {"stereotlm"};
  for (const std::string& argument : request.arguments) words.push_back(argument.c_str());
  const auto count = static_cast<int>(words.size());
  words.push_back(nullptr);
  std::string problem;
  std::vector<std::string> texts = request.arguments;
  texts.push_back(request.folder);
  for (const std::string& text : texts) {
    if (text.find('\0') != std::string::npos)
      problem = fmt::format("'{}..': a NUL character follows: must not be in a text", text.c_str());
  }
  std::error_code error;
  std::filesystem::current_path(request.folder, error);
  if (error) problem = fmt::format("folder '{}': {}", request.folder.string(), error.message());
  if (!problem.empty()) process::say("error", problem);
  answer.end(problem.empty() ? execute(count, words.data()) : kRefused);
  process::client = nullptr;
  // SystemC is elaborated once in a process.
  const bool is_fresh =
      sc_core::sc_get_status() == sc_core::SC_ELABORATION && sc_core::sc_get_top_level_objects().empty();
  return is_fresh && !process::interrupted();
}

// Waits until child.next() would return soon. Returns false if the client has closed its end of `to`.
bool wait_for_news(const process::Child& child, int to) {
  std::array<pollfd, 2> watched = {{{child.descriptor(), POLLIN, 0}, {to, 0, 0}}};
  while (poll(watched.data(), watched.size(), -1) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "poll");
  }
  return watched[1].revents == 0;
}

struct WorkerOptions : Options {
  using Options::Options;
};

int execute_commands(const WorkerOptions& /*options*/) {
  if (process::client != nullptr) process::refuse("worker: cannot be a command for a worker");
  // What libraries print must not get between the documents.
  const int to = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (to < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    throw std::system_error(errno, std::generic_category(), "standard output");
  char last = kEnds;  // what was told
  const auto write = [to](const std::string& bytes) {
    return process::write_all(to, bytes.data(), bytes.size());
  };
  const auto end = [&](const std::string& why) {
    if (last == kEnds) throw std::runtime_error(why);  // there is no request to answer
    write(line_of({{"message", "stereotlm: error: " + why}}) +
          line_of({{"status", kFailed}, {"output", ""}, {"problems", Json::array()}}));
    if (last == kBegins) throw std::runtime_error(why);  // where the next request begins is not known
    last = kEnds;
  };
  // Commands are executed by a child, which may crash. It is there before the request.
  while (true) {
    try {
      process::Child child([](const process::Child::Tell& tell) {
        while (serve_one(tell)) {
        }
      });
      while (true) {
        if (!wait_for_news(child, to)) return kFailed;
        const auto told = child.next();
        if (!told) break;
        if (told->front() == kWasLast) return kDone;
        last = told->front();
        if (!write(told->substr(1))) return kFailed;
      }
    } catch (const std::exception& error) {
      end(process::text_of(error));
    }
  }
}

}  // namespace

void add_worker(Commands& commands) {
  add_command(commands, "worker", "Execute commands for another program, over a pipe", execute_commands,
              kWorkerFooter);
}

}  // namespace stereotlm::cli
