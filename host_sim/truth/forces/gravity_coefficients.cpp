#include "host_sim/truth/forces/gravity_coefficients.h"

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"

namespace vbar::truth {
namespace {

constexpr int kHighestDegree = 2190;  // of the largest published models: limits damaged headers

/// The lines of a coefficient file, comments skipped, and errors that name file and line.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& file) : file_(file), in_(file) {
    if (!in_) throw std::runtime_error(fmt::format("{}: cannot open the gravity model", file.string()));
  }

  /// The words of the next line; at the end of the file an error stating what was expected.
  const std::vector<std::string_view>& next(std::string_view expected) {
    do {
      ++number_;
      if (!std::getline(in_, line_)) fail("the file ends here", expected);
    } while (line_.starts_with('#') || line_.empty());
    split();
    return words_;
  }

  [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
    throw std::runtime_error(fmt::format("{}:{}: {}, expected {}", file_.string(), number_, found, expected));
  }

  [[noreturn]] void fail(std::string_view expected) const { fail(fmt::format("found \"{}\"", line_), expected); }

 private:
  void split() {
    words_.clear();
    std::string_view rest = line_;
    while (true) {
      const auto begin = rest.find_first_not_of(" \t\r");
      if (begin == std::string_view::npos) return;
      const auto end = std::min(rest.find_first_of(" \t\r", begin), rest.size());
      words_.push_back(rest.substr(begin, end - begin));
      rest.remove_prefix(end);
    }
  }

  std::filesystem::path file_;
  files::DataStream in_;
  std::string line_;
  std::vector<std::string_view> words_;
  int number_ = 0;
};

template <class Number>
bool parse(std::string_view word, Number& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

std::string header_text(LineReader& reader, std::string_view key) {
  const auto& words = reader.next(key);
  if (words.size() != 2 || words[0] != key) reader.fail(fmt::format("\"{} VALUE\"", key));
  return std::string(words[1]);
}

template <class Number>
Number header_number(LineReader& reader, std::string_view key, Number above, Number up_to) {
  Number value{};
  if (!parse(header_text(reader, key), value) || !(value > above && value <= up_to)) {
    reader.fail(fmt::format("\"{}\" above {} and up to {}", key, above, up_to));
  }
  return value;
}

}  // namespace

GravityCoefficients load_gravity_coefficients(const std::filesystem::path& file, int degree) {
  LineReader reader(file);
  GravityCoefficients field;
  field.model = header_text(reader, "model");
  field.gm = header_number(reader, "gm_m3ps2", 0.0, 1e21);
  field.radius = header_number(reader, "radius_m", 0.0, 1e9);
  const int max_degree = header_number(reader, "max_degree", 0, kHighestDegree);
  field.tide_system = header_text(reader, "tide_system");
  if (degree < 0 || degree > max_degree) {
    throw std::invalid_argument(
        fmt::format("gravity degree {} asked of {}; it has degrees 0 to {}", degree, file.string(), max_degree));
  }
  if (reader.next("\"coefficients\"").front() != "coefficients") reader.fail("\"coefficients\"");

  field.degree = degree;
  field.c.reserve(GravityCoefficients::index(degree + 1, 0));
  field.s.reserve(field.c.capacity());
  for (int n = 0; n <= max_degree; ++n) {
    for (int m = 0; m <= n; ++m) {
      const auto expected = [&] { return fmt::format("the coefficients C and S of degree {}, order {}", n, m); };
      const auto& words = reader.next(expected());
      int line_n = 0, line_m = 0;
      double c = 0.0, s = 0.0;
      if (words.size() != 4 || !parse(words[0], line_n) || !parse(words[1], line_m) || !parse(words[2], c) ||
          !parse(words[3], s) || line_n != n || line_m != m || !std::isfinite(c) || !std::isfinite(s)) {
        reader.fail(expected());
      }
      if (n <= degree) {
        field.c.push_back(c);
        field.s.push_back(s);
      }
    }
  }
  if (reader.next("\"end\"").front() != "end") reader.fail("\"end\"");
  return field;
}

}  // namespace vbar::truth
