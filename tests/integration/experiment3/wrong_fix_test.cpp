// Wrong integers, held on purpose.

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/integration/experiment3/emulated_pair.h"

namespace vbar::test {
namespace {

TEST(WrongFix, Explore) {
  const CoastingPair coast(900);
  for (int at : {5, 6, 7}) {
    for (int seed = 1; seed <= 4; ++seed) {
      EmulatedPair pair(coast, static_cast<std::uint64_t>(seed));
      pair.fly(at + 1);
      const double before = pair.position_error_m();
      const fsw::Vector6 e0 = pair.error();
      const bool held = pair.hold_shifted(1.0);
      const double after = pair.position_error_m();
      const int wrong = pair.wrong_integers();
      double most = after, moved = (pair.error() - e0).head<3>().norm();
      double released = -1, right = -1;
      while (!pair.done()) {
        pair.fly();
        const bool is_released = pair.gnss().ambiguities().report().releases > 0;
        if (is_released && released < 0) released = pair.elapsed_s();
        if (released < 0) { most = std::max(most, pair.position_error_m()); moved = std::max(moved, (pair.error() - e0).head<3>().norm()); }
        if (pair.is_fixed() && pair.wrong_integers() == 0 && right < 0) right = pair.elapsed_s();
      }
      fmt::print("at {} seed {} held {} wrong {} before {:.3f} after {:.3f} most {:.3f} moved {:.3f} released {} right {} end {:.4f} wrong {} rel {}\n", 10 * at, seed,
                 held, wrong, before, after, most, moved, released, right, pair.position_error_m(), pair.wrong_integers(), pair.gnss().ambiguities().report().releases);
    }
  }
}

}  // namespace
}  // namespace vbar::test
