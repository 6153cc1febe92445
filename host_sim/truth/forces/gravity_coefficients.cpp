#include "host_sim/truth/forces/gravity_coefficients.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"

namespace vbar::truth {

GravityCoefficients load_gravity_coefficients(const std::filesystem::path& file, int degree) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the gravity model", file.string()));
  return read_gravity(stream.view(), file.string(), degree);
}

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

namespace {

using files::TextLines;

enum class Norm { kFull, kNone };

struct Header {
  std::string model = "unknown";
  std::optional<double> gm, radius;
  std::optional<int> max_degree;
  Norm norm = Norm::kFull;
  std::optional<std::string> tide_system;
};

double positive(const TextLines& lines, const Words& words, double up_to) {
  const auto value = files::number_of(words[1]);
  if (!value || !(*value > 0.0 && *value <= up_to))
    lines.refuse(files::quoted(lines.line()), fmt::format("{} above 0 and up to {}", words[0], up_to));
  return *value;
}

int degree_of(const TextLines& lines, const Words& words) {
  const auto value = files::integer_of(words[1]);
  if (!value || *value < 0 || *value > kHighestDegree)
    lines.refuse(files::quoted(lines.line()), fmt::format("max_degree of 0 to {}", kHighestDegree));
  return *value;
}

Norm norm_of(const TextLines& lines, std::string_view name) {
  if (name == "fully_normalized") return Norm::kFull;
  if (name == "unnormalized") return Norm::kNone;
  lines.refuse(fmt::format("norm {}", name), "fully_normalized or unnormalized");
}

void take_keyword(const TextLines& lines, const Words& words, Header& header) {
  if (words.size() < 2) return;
  const std::string_view key = words[0];
  // The limits hold any planet in SI units; the check of both together rejects kilometres.
  if (key == "earth_gravity_constant" || key == "gravity_constant") header.gm = positive(lines, words, 1e21);
  if (key == "radius") header.radius = positive(lines, words, 1e9);
  if (key == "max_degree") header.max_degree = degree_of(lines, words);
  if (key == "norm") header.norm = norm_of(lines, words[1]);
  if (key == "modelname") header.model = files::printable(words[1]);
  if (key == "tide_system") header.tide_system = words[1];
  if (key == "product_type" && words[1] != "gravity_field")
    lines.refuse(fmt::format("product_type {}", words[1]), "gravity_field");
}

/// Reads the header, in which free text may precede the keywords.
Header read_header(TextLines& lines) {
  Header header;
  while (lines.next()) {
    const Words words = lines.words();
    if (words.empty()) continue;
    if (words[0] != "end_of_head") {
      take_keyword(lines, words, header);
      continue;
    }
    const auto need = [&](bool is_there, std::string_view key) {
      if (!is_there) lines.refuse(fmt::format("a header without {}", key), fmt::format("{} before end_of_head", key));
    };
    need(header.gm.has_value(), "earth_gravity_constant");
    need(header.radius.has_value(), "radius");
    need(header.max_degree.has_value(), "max_degree");
    // The model is one of the Earth, in metres.
    if (!(*header.gm > 3.9e14 && *header.gm < 4.1e14) || !(*header.radius > 6.3e6 && *header.radius < 6.4e6))
      lines.refuse(fmt::format("a gravity constant of {} and a radius of {}", *header.gm, *header.radius),
                   "those of the Earth in m^3/s^2 and m");
    if (!header.tide_system || (*header.tide_system != "zero_tide" && *header.tide_system != "tide_free"))
      lines.refuse(fmt::format("tide_system {}", header.tide_system.value_or("missing")),
                   "tide_system zero_tide or tide_free, from the description of the model");
    return header;
  }
  lines.refuse("the end of the file", "end_of_head");
}

/// Normalised over unnormalised coefficient: sqrt((n+m)! / ((2 - delta_m0) (2n+1) (n-m)!)).
double normalisation(int n, int m) {
  double factor = 1.0 / std::sqrt((m == 0 ? 1.0 : 2.0) * (2.0 * n + 1.0));
  for (int k = n - m + 1; k <= n + m; ++k) factor *= std::sqrt(static_cast<double>(k));
  return factor;
}

/// The coefficients up to a degree, and which of them have been read.
class Coefficients {
 public:
  Coefficients(Header header, int degree)
      : header_(std::move(header)),
        degree_(degree),
        c_(GravityCoefficients::index(degree + 1, 0)),
        s_(c_.size()),
        seen_(c_.size()) {}

  void take(const TextLines& lines, const Words& words) {
    if (words[0] != "gfc")
      lines.refuse(fmt::format("the term {}", files::quoted(words[0])),
                   "gfc alone: a static model (one with gfct, trnd, dot, acos or asin changes with time)");
    constexpr std::size_t kMinWords = 5;
    if (words.size() < kMinWords) lines.refuse("gfc, degree, order, C and S");
    const auto n = files::integer_of(words[1]), m = files::integer_of(words[2]);
    const auto c = files::number_of(words[3]), s = files::number_of(words[4]);
    if (!n || !m || !c || !s || *n < 0 || *m < 0 || *m > *n || *n > *header_.max_degree)
      lines.refuse(fmt::format("gfc, degree up to {}, order up to the degree, C and S", *header_.max_degree));
    has_max_degree_ = has_max_degree_ || *n == *header_.max_degree;
    if (*n > degree_) return;
    if (words.size() == kMinWords) lines.check_ended();
    const std::size_t at = GravityCoefficients::index(*n, *m);
    if (seen_[at]) lines.refuse(fmt::format("degree {}, order {} a second time", *n, *m), "each once");
    seen_[at] = true;
    const double factor = header_.norm == Norm::kFull ? 1.0 : normalisation(*n, *m);
    c_[at] = factor * *c;
    s_[at] = factor * *s;
  }

  GravityCoefficients finish(const TextLines& lines) {
    const std::size_t first = GravityCoefficients::index(std::min(2, degree_ + 1), 0);
    for (int n = 2; n <= degree_; ++n)
      for (int m = 0; m <= n; ++m)
        if (!seen_[GravityCoefficients::index(n, m)]) refuse_end(lines, n, m);
    if (!has_max_degree_) refuse_end(lines, *header_.max_degree, 0);
    // Degrees 0 and 1 may be left out: the mass, and the centre of mass as origin.
    if (!seen_[0]) c_[0] = 1.0;
    for (std::size_t at = 1; at < first && at < c_.size(); ++at)
      if (std::abs(c_[at]) > kLargestDegreeOne || std::abs(s_[at]) > kLargestDegreeOne)
        lines.refuse("coefficients of degree 1 other than 0", "a model about the Earth's centre of mass");
    if (std::abs(c_[0] - 1.0) > kLargestDegreeOne) lines.refuse(fmt::format("C of degree 0 of {}", c_[0]), "1");
    GravityCoefficients field;
    field.model = header_.model;
    field.tide_system = *header_.tide_system;
    field.gm = *header_.gm;
    field.radius = *header_.radius;
    field.degree = degree_;
    field.c = std::move(c_);
    field.s = std::move(s_);
    return field;
  }

 private:
  static constexpr double kLargestDegreeOne = 1e-8;

  [[noreturn]] static void refuse_end(const TextLines& lines, int n, int m) {
    lines.refuse("the end of the file", fmt::format("the coefficients of degree {}, order {}", n, m));
  }

  Header header_;
  int degree_;
  bool has_max_degree_ = false;
  std::vector<double> c_, s_;
  std::vector<bool> seen_;
};

}  // namespace

bool is_icgem(std::string_view text) {
  return text.substr(0, 100000).find("end_of_head") != std::string_view::npos;
}

GravityCoefficients read_icgem(std::string_view text, const std::string& file, int degree) {
  TextLines lines(text, file);
  Header header = read_header(lines);
  check_degree(file, degree, *header.max_degree);
  constexpr int kHighestUnnormalised = 100;  // beyond it coefficients leave the range of double precision
  if (header.norm == Norm::kNone && degree > kHighestUnnormalised)
    lines.refuse(fmt::format("degree {} of unnormalized coefficients", degree),
                 fmt::format("degrees up to {}", kHighestUnnormalised));
  Coefficients coefficients(std::move(header), degree);
  while (lines.next()) {
    const Words words = lines.words();
    if (!words.empty()) coefficients.take(lines, words);
  }
  return coefficients.finish(lines);
}

std::span<const GravityFormat> gravity_formats() {
  static constexpr std::array kFormats{
      GravityFormat{"ICGEM gravity field (.gfc)", is_icgem, read_icgem},
      GravityFormat{"the table of data/gravity", is_gravity_table, read_gravity_table},
  };
  return kFormats;
}

GravityCoefficients read_gravity(std::string_view text, const std::string& file, int degree) {
  const auto formats = gravity_formats();
  const auto format = std::ranges::find_if(formats, [&](const auto& one) { return one.recognises(text); });
  if (format != formats.end()) return format->read(text, file, degree);
  files::TextLines lines(text, file);
  lines.next();
  std::vector<std::string_view> names;
  for (const GravityFormat& one : formats) names.push_back(one.name);
  lines.refuse(fmt::format("a gravity model in one of the formats {}", fmt::join(names, ", ")));
}

void check_degree(const std::string& file, int degree, int max_degree) {
  if (degree < 0 || degree > max_degree) {
    throw std::invalid_argument(
        fmt::format("gravity degree {} asked of {}; it has degrees 0 to {}", degree, file, max_degree));
  }
}

}  // namespace vbar::truth
