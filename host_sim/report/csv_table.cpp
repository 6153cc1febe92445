#include "host_sim/report/csv_table.h"

#include <algorithm>

#include "host_sim/files/output_file.h"

namespace vbar::report {

void append_text(std::string& line, std::string_view text) {
  const bool quoted = text.find_first_of(",\"") != std::string_view::npos;
  if (quoted) line += '"';
  for (const char c : text) {
    if (c == '"') line += '"';
    line += c == '\n' || c == '\r' ? ' ' : c;
  }
  if (quoted) line += '"';
}

bool split_cells(std::string_view line, std::vector<std::string>& cells) {
  cells.assign(1, {});
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    const bool doubled = quoted && c == '"' && k + 1 < line.size() && line[k + 1] == '"';
    if (doubled) {
      cells.back() += '"';
      ++k;
    } else if (c == '"') {
      const bool at_start = cells.back().empty() && (k == 0 || line[k - 1] == ',');
      const bool at_end = k + 1 == line.size() || line[k + 1] == ',';
      if (quoted ? !at_end : !at_start) return false;
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return !quoted;
}

std::string word_of(const Codes& codes, int value) {
  std::string words;
  int left = value;
  for (int k = 0; k < codes.count; ++k) {
    const Code& code = codes.codes[k];
    if (!codes.are_bits && code.value == value) return code.word;
    if (!codes.are_bits || (left & code.value) == 0) continue;
    words.append(words.empty() ? "" : "+").append(code.word);
    left &= ~code.value;
  }
  if (codes.are_bits && value == 0) return "none";
  return left != 0 || words.empty() ? std::to_string(value) : words;
}

std::optional<int> code_of(const Codes& codes, std::string_view word) {
  int number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc{} && end == word.data() + word.size()) return number;
  if (codes.are_bits && word == "none") return 0;
  int sum = 0;
  for (std::size_t start = 0; start < word.size();) {
    const std::size_t stop = codes.are_bits ? std::min(word.find('+', start), word.size()) : word.size();
    std::string name(word.substr(start, stop - start));
    std::ranges::replace(name, ' ', '_');
    const Code* const last = codes.codes + codes.count;
    const Code* const found = std::find_if(codes.codes, last, [&](const Code& code) { return code.word == name; });
    if (found == last) return std::nullopt;
    sum += found->value;
    start = stop + 1;
  }
  return word.empty() ? std::nullopt : std::optional(sum);
}

std::vector<std::string> read_lines(const std::filesystem::path& file) {
  const std::string text = files::read_text_file(file);
  std::vector<std::string> lines;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::size_t content_end = end > start && text[end - 1] == '\r' ? end - 1 : end;
    lines.push_back(text.substr(start, content_end - start));
    start = end + 1;
  }
  return lines;
}

}  // namespace vbar::report
