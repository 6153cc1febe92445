#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/forces/gravity_formats/gravity_formats.h"

namespace vbar::truth {
namespace {

using files::TextLines;
using Words = std::vector<std::string_view>;

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

}  // namespace vbar::truth
