#include "host_sim/truth/forces/gravity_coefficients.h"

#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/truth/forces/gravity_formats/gravity_formats.h"

namespace vbar::truth {

GravityCoefficients load_gravity_coefficients(const std::filesystem::path& file, int degree) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot open the gravity model", file.string()));
  return read_gravity(stream.view(), file.string(), degree);
}

}  // namespace vbar::truth
