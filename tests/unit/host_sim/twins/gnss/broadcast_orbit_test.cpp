#include "host_sim/twins/gnss/broadcast_orbit.h"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/ephemeris_file.h"
#include "host_sim/twins/gnss/navigation_message.h"
#include "host_sim/twins/gnss/system_time.h"
#include "tests/support/accuracy.h"
#include "tests/support/paths.h"

namespace vbar::twins::gnss {
namespace {

const std::filesystem::path kFiles = std::filesystem::path(vbar::tests::source_path("data")) / "gps";

std::vector<Ephemeris> all_sets() {
  std::vector<Ephemeris> sets = read_ephemeris_file(kFiles / "gps_2011_10_20.csv").satellites;
  const std::vector<Ephemeris> others = read_ephemeris_file(kFiles / "galileo_beidou_2013_07_19.csv").satellites;
  sets.insert(sets.end(), others.begin(), others.end());
  return sets;
}

Ephemeris set_of(SatelliteId satellite) {
  for (const Ephemeris& set : all_sets())
    if (set.satellite == satellite) return set;
  ADD_FAILURE() << name_of(satellite);
  return {};
}

// A satellite's next set of the same broadcast file (brdc2930.11n at 14h; brdm2000.13p at 13h), as broadcast.
struct NextSet {
  SatelliteId satellite;
  int week;
  double toe_s, sqrt_a, e, m0, delta_n, omega0, omega_dot, i0, i_dot, omega, cuc, cus, cic, cis, crc, crs, af0, af1;
};
constexpr NextSet kNextSets[] = {
    {{System::kGps, 5},  1658,
     396000.0,           0.515377498436e4,
     0.252750818618e-2,  0.264024775612e1,
     0.487091717897e-8,  -0.245705288143e1,
     -0.824391482071e-8, 0.953027185956,
     -0.273225666660e-9, 0.171539711260,
     0.745058059692e-6,  0.690855085850e-5,
     0.167638063431e-7,  -0.931322574616e-8,
     0.2445e3,           0.152187500000e2,
     -0.234236475080e-3, -0.511590769747e-11},
    {{System::kGps, 2},
     1658,
     396000.0,
     0.515358279991e4,
     0.105527443811e-1,
     0.626945680701,
     0.526843368931e-8,
     0.276406486624e1,
     -0.844285175106e-8,
     0.939103811935,
     0.364300881128e-10,
     -0.292249261976e1,
     0.905245542526e-6,
     0.810809433460e-5,
     0.117346644402e-6,
     0.150874257088e-6,
     0.211e3,
     0.157812500000e2,
     0.361695885658e-3,
     0.181898940355e-11},
    {{System::kGalileo, 11},
     1749,
     478800.0,
     5.440608966827e3,
     1.894889865071e-4,
     2.992282860295,
     3.198704667460e-9,
     3.140894355977,
     -5.550231189407e-9,
     9.588570783489e-1,
     5.628805890930e-10,
     -3.355577063311e-1,
     -1.484528183937e-6,
     1.186504960060e-5,
     -7.636845111847e-8,
     1.341104507446e-7,
     8.5875e1,
     -2.884375e1,
     1.266586128622e-3,
     8.243716820289e-11},
    {{System::kBeidou, 1},
     393,
     478800.0,
     6.493447040558e3,
     3.356511006132e-4,
     1.821857681331,
     -6.102039888740e-9,
     5.861605486939e-1,
     7.035650205929e-9,
     1.066649120503e-1,
     -2.814402945465e-10,
     -2.747316070753,
     1.788884401321e-5,
     -1.925975084305e-5,
     6.379559636116e-8,
     1.559965312481e-7,
     5.957968750000e2,
     5.429843750000e2,
     -5.240145837888e-4,
     1.608224664551e-11},
    {{System::kBeidou, 6},
     393,
     478800.0,
     6.493434284210e3,
     3.020433941856e-3,
     -2.366768514734,
     1.438988511076e-9,
     -1.471050296041,
     -1.926508818254e-9,
     9.509222136128e-1,
     -1.074330464462e-9,
     -3.110938785190,
     -6.328336894512e-7,
     1.485226675868e-5,
     8.521601557732e-8,
     -1.541338860989e-7,
     -2.136093750000e2,
     -1.290625e1,
     3.750132163987e-4,
     -1.486721856736e-11},
};

Ephemeris ephemeris_of(const NextSet& next) {
  Ephemeris set;
  set.satellite = next.satellite;
  const System system = next.satellite.system;
  set.toe = gps_time_of(system, next.week, static_cast<std::int64_t>(next.toe_s));
  set.sqrt_a = next.sqrt_a;
  set.e = next.e;
  set.m0 = next.m0;
  set.delta_n = next.delta_n;
  set.node_at_toe = next.omega0 - earth_rate(system) * next.toe_s;
  set.omega_dot = next.omega_dot;
  set.i0 = next.i0;
  set.i_dot = next.i_dot;
  set.omega = next.omega;
  set.cuc = next.cuc;
  set.cus = next.cus;
  set.cic = next.cic;
  set.cis = next.cis;
  set.crc = next.crc;
  set.crs = next.crs;
  set.af0 = next.af0;
  set.af1 = next.af1;
  return set;
}

// Two sets that a control segment fitted to overlapping arcs tell the same position between their reference times
// within what broadcast orbits are worth: about 3 m of GPS and Galileo over an hour, 10 m of the young BeiDou of 2013.
// A wrong sign of any harmonic term would show as hundreds of metres, a wrong geostationary frame as thousands of km.
TEST(BroadcastOrbit, NeighbouringRealSetsAgree) {
  for (const NextSet& next : kNextSets) {
    const Ephemeris later = ephemeris_of(next);
    const Ephemeris earlier = set_of(next.satellite);
    const double half_s = seconds(later.toe - earlier.toe) / 2.0;
    const SatelliteState a = satellite_state(earlier, earlier.toe, half_s);
    const SatelliteState b = satellite_state(later, earlier.toe, half_s);
    const double limit_m = next.satellite.system == System::kBeidou ? 10.0 : 3.0;
    EXPECT_LT((a.position_ecef - b.position_ecef).norm(), limit_m) << name_of(next.satellite);
    EXPECT_NEAR(a.clock_s, b.clock_s, 5e-9) << name_of(next.satellite);  // upload to upload, ns
  }
}

// The velocity is the position's derivative: central differences over 2 s err by a'''/6 (1e-4 m/s^... below 1e-7 m/s)
// and by rounding of 27,000 km (4e-9 m / 1 s).
TEST(BroadcastOrbit, VelocityIsDerivative) {
  accuracy::Largest largest;
  for (const Ephemeris& set : all_sets()) {
    const SatelliteState here = satellite_state(set, set.toe, 3000.0);
    const fsw::Vector3 difference =
        (satellite_state(set, set.toe, 3001.0).position_ecef - satellite_state(set, set.toe, 2999.0).position_ecef) /
        2.0;
    largest.add((here.velocity_ecef - difference).norm());
    const double clock_difference =
        (satellite_state(set, set.toe, 3001.0).clock_s - satellite_state(set, set.toe, 2999.0).clock_s) / 2.0;
    EXPECT_NEAR(here.clock_drift, clock_difference, 1e-18) << name_of(set.satellite);
  }
  EXPECT_LT(largest, 3e-5);  // third derivative: 27e6 m (1.5e-4/s)^3 / 6 = 1.5e-5 m/s
}

// Sets of other reference times describe one motion: two days on, to the rounding of angles grown by 2 pi 4 times.
TEST(BroadcastOrbit, ReferenceTimeIsFree) {
  for (Ephemeris set : all_sets()) {
    if (is_geostationary(set.satellite)) {
      set.omega_dot = set.i_dot = set.cuc = set.cus = set.cic = set.cis = set.crc = set.crs = 0.0;
    }
    const fsw::GpsTime later = set.toe + fsw::duration_of_seconds(2 * 86400 + 7200);
    const Ephemeris moved = with_reference_time(set, later);
    EXPECT_EQ(moved.toe, later);
    for (const double offset_s : {-7200.0, 0.0, 4321.0}) {
      const SatelliteState a = satellite_state(set, later, offset_s);
      const SatelliteState b = satellite_state(moved, later, offset_s);
      EXPECT_LT((a.position_ecef - b.position_ecef).norm(), 1e-5) << name_of(set.satellite);
      EXPECT_LT((a.velocity_ecef - b.velocity_ecef).norm(), 1e-9) << name_of(set.satellite);
      EXPECT_NEAR(a.clock_s, b.clock_s, 1e-16) << name_of(set.satellite);
    }
  }
}

// The message's bits cost what half of a last bit moves a satellite: 2^-31 semicircles of four angles at 27,000 to
// 42,000 km, at most 4 x 0.03 m.
TEST(NavigationMessage, RoundingCostsCentimetres) {
  accuracy::Largest largest;
  for (const Ephemeris& set : all_sets()) {
    const fsw::GpsTime toe = set.toe;
    const Ephemeris rounded = rounded_to_message(set);
    largest.add(
        (satellite_state(set, toe, 3600.0).position_ecef - satellite_state(rounded, toe, 3600.0).position_ecef).norm());
    // Rounded once is rounded for good.
    EXPECT_DOUBLE_EQ(rounded_to_message(rounded).m0, rounded.m0);
  }
  EXPECT_LT(largest, 0.12);
  EXPECT_GT(largest, 1e-4);
}

// A number that its field cannot hold is refused by name.
TEST(NavigationMessage, RefusesWhatDoesNotFit) {
  Ephemeris set = set_of({System::kGps, 5});
  set.af0 = 0.01;
  try {
    lnav_subframes(set, 3, set.toe);
    FAIL();
  } catch (const std::out_of_range& error) {
    EXPECT_NE(std::string(error.what()).find("G05: af0 = 0.01"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace vbar::twins::gnss
