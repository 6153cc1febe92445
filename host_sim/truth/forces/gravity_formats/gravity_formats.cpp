#include "host_sim/truth/forces/gravity_formats/gravity_formats.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/files/text_lines.h"

namespace vbar::truth {

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
