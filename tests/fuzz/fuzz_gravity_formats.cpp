// Gravity models with arbitrary contents. Promise: as many finite coefficients as the degree has, or one exception that
// names the file.

#include <cmath>
#include <exception>
#include <string_view>

#include "host_sim/truth/forces/gravity_coefficients.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::truth;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const int degree : {0, 3}) {
    try {
      const GravityCoefficients model = read_gravity(text, "file.txt", degree);
      VBAR_FUZZ_EXPECT(model.c.size() == GravityCoefficients::index(degree + 1, 0) && model.s.size() == model.c.size());
      for (const double c : model.c) VBAR_FUZZ_EXPECT(std::isfinite(c));
      for (const double s : model.s) VBAR_FUZZ_EXPECT(std::isfinite(s));
    } catch (const std::exception& error) {
      VBAR_FUZZ_EXPECT(std::string_view(error.what()).find("file.txt") != std::string_view::npos);
    }
  }
  return 0;
}
