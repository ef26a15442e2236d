#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <vector>

// Forms of bytes and words as text.
namespace stereotlm::files {

// SHA-256 as 64 lower-case hexadecimal digits.
std::string sha256_hex(const void* bytes, std::size_t count);

// The SHA-256 of the content of a file, which is read in pieces. Throws std::runtime_error with path and
// cause if the file cannot be read.
std::string sha256_file(const std::string& path);

// The bytes in base64 (RFC 4648), padded, without line breaks.
std::string base64(const void* bytes, std::size_t size);

// The word as a POSIX shell reads it: in quotes if it needs them.
std::string shell_word(const std::string& word);

// The words as a command of a POSIX shell.
std::string shell_command(const std::vector<std::string>& words);

// Ascending numbers with runs of them as ranges: "0, 2-5, 9" with the separator ", ".
std::string ranges_text(const std::vector<std::uint64_t>& numbers, const std::string& separator);

// The number, or 0 if it is shown as 0 with so many decimals: so it is not shown as "-0.00".
double without_minus_zero(double number, int decimals);

// The text of a JSON document in the form of the result files: keys in insertion order, two spaces of indent,
// a container without containers on one line, numbers as the shortest decimals that read back equal, a
// newline at the end. With `replaces`, bytes that are not UTF-8 are replaced; else a string with such bytes
// throws std::invalid_argument. A number that is not finite throws it always.
std::string json_text(const nlohmann::ordered_json& document, bool replaces = false);

// A text is not JSON, has a number that is too large for it, or is nested more than 100 deep.
struct JsonError : std::runtime_error {
  JsonError(std::size_t at_line, const std::string& what) : std::runtime_error(what), line(at_line) {}
  std::size_t line;  // from 1
};

// Parses a JSON document. Throws JsonError.
nlohmann::ordered_json parse_json(const std::string& text);

}  // namespace stereotlm::files
