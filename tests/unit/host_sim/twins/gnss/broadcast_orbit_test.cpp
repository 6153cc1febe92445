#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/ephemeris_file.h"
#include "host_sim/twins/gnss/navigation_message.h"
#include "host_sim/twins/gnss/satellite.h"
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

namespace {

// A subframe 4 of the real satellite PRN 5, as a u-blox receiver reported it (UBX-RXM-SFRBX in the test data of the
// decoder pyubx2; that receiver inverts each word whose predecessor ends with D30 = 1, which is undone here).
constexpr std::array<std::uint32_t, 10> kReportedData{0x8B0140, 0x4B45B2, 0x5E26F3, 0x63FD25, 0xFD4000,
                                                      0xA10C23, 0x92F454, 0x8D6F1C, 0xB71F0D, 0xD5FFD3};
constexpr std::array<std::uint32_t, 10> kTransmitted{
    0x22C0502E, 0x12D16C80, 0x1789BCED, ~0x18FF4950U & 0x3FFFFFFFU, ~0x3F50000FU & 0x3FFFFFFFU,
    0x284308F0, 0x24BD152A, 0x235BC727, ~0x2DC7C349U & 0x3FFFFFFFU, 0x357FF4E0};

TEST(LnavParity, WordsOfARealSatellite) {
  std::uint32_t previous = 0;
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_EQ(lnav_word(kReportedData[k], previous), kTransmitted[k]) << "word " << k + 1;
    previous = kTransmitted[k];
  }
}

// The two bits that the satellite solved for in words 2 and 10 are found again.
TEST(LnavParity, SubframeOfARealSatelliteWithItsSolvedBits) {
  Subframe subframe{};
  for (std::size_t k = 0; k < 10; ++k)
    for (std::size_t byte = 0; byte < 3; ++byte)
      subframe[3 * k + byte] = static_cast<std::uint8_t>(kReportedData[k] >> (16U - 8U * byte) & 0xFFU);
  subframe[5] &= 0xFCU;
  subframe[29] &= 0xFCU;
  EXPECT_EQ(lnav_transmitted(subframe), kTransmitted);
}

std::uint32_t field(const Subframe& subframe, std::size_t first_bit, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t k = first_bit; k < first_bit + count; ++k)
    value = value << 1U | (subframe[k / 8] >> (7U - k % 8) & 1U);
  return value;
}

// Positions (bits of the subframe without parity) and scales: IS-GPS-200N figure 20-1 sheet 8, tables 20-IX and 20-X.
// Klobuchar numbers on their grid.
TEST(LnavParity, PageEighteenHasTheFieldsOfTheInterfaceSpecification) {
  BroadcastCorrections corrections;
  corrections.klobuchar.alpha = {3.0 * 0x1p-30, -4.0 * 0x1p-27, 5.0 * 0x1p-24, -6.0 * 0x1p-24};
  corrections.klobuchar.beta = {7.0 * 0x1p11, -8.0 * 0x1p14, 9.0 * 0x1p16, -10.0 * 0x1p16};
  corrections.utc_a0_s = -11.0 * 0x1p-30;
  corrections.utc_a1 = 12.0 * 0x1p-50;
  const UtcOffset utc{.gps_minus_utc_s = 15, .change_week = 1512, .change_day = 4};
  const Subframe page = lnav_page_18(corrections, utc, gps_time_of(System::kGps, 1645, 90030));
  EXPECT_EQ(field(page, 0, 8), 0x8BU);
  EXPECT_EQ(field(page, 24, 17), 90030U / 6U + 4U);  // beginning of the next subframe
  EXPECT_EQ(field(page, 43, 3), 4U);
  EXPECT_EQ(field(page, 48, 2), 1U);
  EXPECT_EQ(field(page, 50, 6), 56U);
  constexpr std::array<std::uint32_t, 8> kIonosphere{3, 0x100 - 4, 5, 0x100 - 6, 7, 0x100 - 8, 9, 0x100 - 10};
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(field(page, 56 + 8 * k, 8), kIonosphere[k]) << k;
  EXPECT_EQ(field(page, 120, 24), 12U);
  EXPECT_EQ(field(page, 144, 32), 0xFFFFFFFFU - 10U);
  EXPECT_EQ(field(page, 176, 8), 36U);  // 147456 s in units of 4096 s
  EXPECT_EQ(field(page, 184, 8), 1645U % 256U);
  EXPECT_EQ(field(page, 192, 8), 15U);
  EXPECT_EQ(field(page, 200, 8), 1512U % 256U);
  EXPECT_EQ(field(page, 208, 8), 4U);
  EXPECT_EQ(field(page, 216, 8), 15U);
}

TEST(LnavParity, DummyPageNamesNoSatellite) {
  const Subframe page = lnav_dummy_page(5, gps_time_of(System::kGps, 1645, 604770));
  EXPECT_EQ(field(page, 24, 17), 0U);  // the next subframe begins the week
  EXPECT_EQ(field(page, 43, 3), 5U);
  EXPECT_EQ(field(page, 50, 6), 0U);
  for (std::size_t k = 56; k < 238; k += 2) EXPECT_EQ(field(page, k, 2), 2U) << k;
}

TEST(LnavParity, ANumberThatDoesNotFitPageEighteenIsRefused) {
  BroadcastCorrections corrections;
  corrections.klobuchar.alpha[0] = 1.0;
  EXPECT_THROW(lnav_page_18(corrections, {}, gps_time_of(System::kGps, 1645, 0)), std::out_of_range);
}

}  // namespace

namespace {

constexpr const char* kColumns =
    "satellite,week,toe_s,toc_s,sqrt_a,e,m0,delta_n,omega0,omega_dot,i0,i_dot,omega,cuc,cus,cic,cis,crc,crs,af0,af1,"
    "af2,group_delay_s\n";
constexpr const char* kNumbers =
    "1658,388800,388784,5153.66,0.0004,1,2,3,4,5,6,7,8,9,10,11,12,13,1e-4,1e-6,1e-12,5e-9\n";

// A file of one test process, removed at its end.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() / fmt::format("vbar_ephemerides_{}.csv", ::getpid())) {
    std::ofstream(path_) << text;
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() { std::filesystem::remove(path_); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string refusal(const std::string& text) {
  const ScratchFile file(text);
  try {
    read_ephemeris_file(file.path());
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    const std::string name = file.path().string();
    return message.starts_with(name) ? message.substr(name.size()) : message;
  }
  return "accepted";
}

// The clock's reference time is moved to toe, 16 s after toc: af0 + 16 af1 + 256 af2.
TEST(EphemerisFile, ReadsNumbersIntoTheirPlaces) {
  const ScratchFile file(std::string("# a comment\nutc_a0_a1,1e-9,2e-15\n") + kColumns + "E07," + kNumbers);
  const EphemerisFile read = read_ephemeris_file(file.path());
  ASSERT_EQ(read.satellites.size(), 1U);
  const Ephemeris& set = read.satellites.front();
  EXPECT_EQ(set.satellite, (SatelliteId{System::kGalileo, 7}));
  EXPECT_EQ(set.toe.ns, (1658 * 604800LL + 388800) * 1'000'000'000LL);
  EXPECT_EQ(set.m0, 1.0);
  EXPECT_EQ(set.omega, 7.0);
  EXPECT_EQ(set.crs, 13.0);
  EXPECT_NEAR(set.af0, 1e-4 + 16e-6 + 256e-12, 1e-18);
  EXPECT_NEAR(set.af1, 1e-6 + 32e-12, 1e-18);
  EXPECT_EQ(set.group_delay_s, 5e-9);
  EXPECT_EQ(read.corrections.utc_a1, 2e-15);
}

// A group delay of 5e-9 s cut to 5 s is a number too.
TEST(EphemerisFile, ALastNumberThatIsCutShortIsRefused) {
  const std::string text = std::string(kColumns) + "E07," + kNumbers;
  EXPECT_EQ(refusal(text), "accepted");
  for (const std::size_t cut : {1U, 4U})
    EXPECT_EQ(refusal(text.substr(0, text.size() - cut)),
              ":2: found a last row without a line feed, expected one: its last number may be cut short");
}

TEST(EphemerisFile, RefusesWithLineAndReason) {
  const std::string head = kColumns;
  EXPECT_EQ(refusal(""), ": holds no satellite");
  EXPECT_EQ(refusal(head + "X05," + kNumbers),
            ":2: \"X05\" is not a satellite; accepted are G, E or C and a number from 01 to 63");
  EXPECT_EQ(refusal(head + "G05,1658,12\n"), ":2: 2 numbers instead of 22");
  EXPECT_EQ(refusal(head + "G05,nan," + kNumbers), ":2: \"nan\" is not a number");
  EXPECT_EQ(refusal(head + "G05,1," + kNumbers), ":2: more than 22 numbers");
  EXPECT_EQ(refusal("klobuchar_alpha,1,2\n" + head), ":1: klobuchar_alpha needs 4 numbers");
  std::string flat = kNumbers;
  flat.replace(flat.find("0.0004"), 6, "0.9");
  EXPECT_EQ(refusal(head + "G05," + flat), ":2: an eccentricity of 0.9 does not lie between 0 and 0.2");
  EXPECT_THROW(read_ephemeris_file("/nonexistent"), std::runtime_error);
}

}  // namespace

}  // namespace vbar::twins::gnss
