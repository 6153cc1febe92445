#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace vbar::files {

/// `text` with every `what`, which is not empty, in it replaced.
[[nodiscard]] inline std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

// Text of a data file as its producer distributes it: compressed by gzip, with a byte order mark, or not text at all.

/// Bytes of a decompressed text: twice the largest gravity model that is published (degree 2190).
inline constexpr std::size_t kLargestText = std::size_t{1} << 29;

/// The text in `contents`, those of `file`: gzip streams are decompressed, a byte order mark of UTF-8 is dropped.
/// Throws std::runtime_error that names the file and what was found, for a gzip stream that is damaged, cut short or
/// longer than `largest` bytes, for other compressions, and for contents that are not text.
[[nodiscard]] std::string plain_text(std::string contents, const std::string& file, std::size_t largest = kLargestText);

// Text of a data file line by line, in columns or words, with errors that name file, line, what was found and what is
// accepted: the base of the readers of published formats.

/// what() is "file:line: found ..., expected ...".
class FormatError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns the text without blanks at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The whole of `text`, blanks at either end aside, as a finite number; Fortran's exponents (1.0D-03) and a leading
/// plus are accepted. Nothing otherwise.
[[nodiscard]] std::optional<double> number_of(std::string_view text);

/// Parses a decimal integer in the same way.
[[nodiscard]] std::optional<int> integer_of(std::string_view text);

/// The part of `text` at the separators; blanks about the parts stay.
[[nodiscard]] std::vector<std::string_view> split_at(std::string_view text, char separator);

/// Goes through a text, which must outlive it. Lines end with a line feed, a carriage return before it is dropped.
class TextLines {
 public:
  /// `file`: its name, for messages.
  TextLines(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {}

  /// Goes to the next line; false behind the last one.
  bool next();

  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] int number() const { return number_; }  ///< number of the line, from 1
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] bool is_blank() const { return trimmed(line_).empty(); }

  /// Columns `first` to `last` of the line, counted from 1 as format descriptions do; what the line lacks is left out.
  [[nodiscard]] std::string_view columns(std::size_t first, std::size_t last) const;

  /// The number in these columns, blank for none: of Fortran's fixed fields, whose last digit stands in the last
  /// column. Refuses what is not a number of `what`, and a line that ends within it, as one that is cut short does.
  [[nodiscard]] std::optional<double> number_or_blank_in(std::size_t first, std::size_t last,
                                                         std::string_view what) const;

  /// Reads a number that must be present, and an integer.
  [[nodiscard]] double number_in(std::size_t first, std::size_t last, std::string_view what) const;
  [[nodiscard]] int integer_in(std::size_t first, std::size_t last, std::string_view what) const;

  /// Whether the line ends within a field in these columns.
  [[nodiscard]] bool is_cut_in(std::size_t first, std::size_t last) const;

  /// Whether a line feed ends the line; the last line of a file that was cut short has none.
  [[nodiscard]] bool is_ended() const { return is_ended_; }

  /// Refuses a line without a line feed: of formats in which its last number may be cut short.
  void check_ended() const;

  /// The words of the line, between blanks and tabulators.
  [[nodiscard]] std::vector<std::string_view> words() const;

  /// "file:line: found "the line", expected ...".
  [[noreturn]] void refuse(std::string_view expected) const;
  [[noreturn]] void refuse(std::string_view found, std::string_view expected) const;

 private:
  std::string_view rest_;
  std::string_view line_;
  std::string file_;
  int number_ = 0;
  bool is_ended_ = false;
};

/// Text of a file for a message: in quotation marks, at most 100 characters of it, without control characters.
[[nodiscard]] std::string quoted(std::string_view text);

/// A message that may hold the text of foreign files and their names, on one line: a question mark in place of each
/// control character, so that no terminal acts upon it, and of each byte that is not UTF-8.
[[nodiscard]] std::string printable(std::string_view message);

// Errors of a program on its standard error, one line each: names, paths and values of foreign origin that a message
// quotes act upon no terminal and look like no second message.

/// Prints "program: message" without control characters. Standard error may be closed or full.
void print_error(std::string_view program, std::string_view message);

/// Returns the text of an error in a command line, likewise.
[[nodiscard]] std::string parse_error_text(std::string_view message);

/// Lets a parser of command lines, a CLI::App, print its errors by parse_error_text().
template <class Parser>
void print_parse_errors_by_line(Parser& parser) {
  parser.failure_message([](const auto* /*command*/, const auto& error) { return parse_error_text(error.what()); });
}

}  // namespace vbar::files
