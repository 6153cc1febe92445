#include <cmath>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/forces/gravity_formats/gravity_formats.h"

namespace vbar::truth {
namespace {

using Words = std::vector<std::string_view>;

/// The lines of the file without comments.
class LineReader {
 public:
  LineReader(std::string_view text, const std::string& file) : lines_(text, file) {}

  /// The words of the next line; at the end of the file an error stating what was expected.
  Words next(std::string_view expected) {
    do {
      if (!lines_.next()) lines_.refuse("the end of the file", expected);
    } while (lines_.line().starts_with('#') || lines_.line().empty());
    Words words = lines_.words();
    if (words.empty()) lines_.refuse(expected);
    return words;
  }

  [[noreturn]] void fail(std::string_view expected) const { lines_.refuse(expected); }

 private:
  files::TextLines lines_;
};

std::string header_text(LineReader& reader, std::string_view key) {
  const Words words = reader.next(key);
  if (words.size() != 2 || words[0] != key) reader.fail(fmt::format("\"{} VALUE\"", key));
  return std::string(words[1]);
}

double header_number(LineReader& reader, std::string_view key, double up_to) {
  const auto value = files::number_of(header_text(reader, key));
  if (!value || !(*value > 0.0 && *value <= up_to)) reader.fail(fmt::format("\"{}\" above 0 and up to {}", key, up_to));
  return *value;
}

int header_integer(LineReader& reader, std::string_view key, int up_to) {
  const auto value = files::integer_of(header_text(reader, key));
  if (!value || *value <= 0 || *value > up_to) reader.fail(fmt::format("\"{}\" above 0 and up to {}", key, up_to));
  return *value;
}

}  // namespace

bool is_gravity_table(std::string_view text) {
  files::TextLines lines(text, "");
  while (lines.next())
    if (!lines.line().starts_with('#') && !lines.line().empty()) return lines.line().starts_with("model ");
  return false;
}

GravityCoefficients read_gravity_table(std::string_view text, const std::string& file, int degree) {
  LineReader reader(text, file);
  GravityCoefficients field;
  field.model = header_text(reader, "model");
  field.gm = header_number(reader, "gm_m3ps2", 1e21);
  field.radius = header_number(reader, "radius_m", 1e9);
  const int max_degree = header_integer(reader, "max_degree", kHighestDegree);
  field.tide_system = header_text(reader, "tide_system");
  check_degree(file, degree, max_degree);
  if (reader.next("\"coefficients\"").front() != "coefficients") reader.fail("\"coefficients\"");

  field.degree = degree;
  field.c.reserve(GravityCoefficients::index(degree + 1, 0));
  field.s.reserve(field.c.capacity());
  for (int n = 0; n <= max_degree; ++n) {
    for (int m = 0; m <= n; ++m) {
      const auto expected = [&] { return fmt::format("the coefficients C and S of degree {}, order {}", n, m); };
      const Words words = reader.next(expected());
      if (words.size() != 4) reader.fail(expected());
      const auto c = files::number_of(words[2]), s = files::number_of(words[3]);
      if (files::integer_of(words[0]) != n || files::integer_of(words[1]) != m || !c || !s) reader.fail(expected());
      if (n <= degree) {
        field.c.push_back(*c);
        field.s.push_back(*s);
      }
    }
  }
  if (reader.next("\"end\"").front() != "end") reader.fail("\"end\"");
  return field;
}

}  // namespace vbar::truth
