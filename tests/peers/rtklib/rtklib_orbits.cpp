// RTKLIB's eph2pos as a program. Each line of standard input:
//
//   system (1 GPS, 8 Galileo, 32 BeiDou)  prn  toe_ns  toc_ns  time_ns  then 20 elements in the order of Ephemeris
//
// gives a line: x y z clock. Times are ns of GPS time since 1980-01-06. Debian has the library but no header, so what
// is called is declared here, as in rtklib.h of release 2.4.3 b34.

#include <array>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <ctime>

extern "C" {

struct gtime_t {
  time_t time;
  double sec;
};

struct eph_t {
  int sat, iode, iodc, sva, svh, week, code, flag;
  gtime_t toe, toc, ttr;
  double A, e, i0, OMG0, omg, M0, deln, OMGd, idot, crc, crs, cuc, cus, cic, cis, toes, fit, f0, f1, f2;
  double tgd[6], Adot, ndot;
};

int satno(int sys, int prn);
void eph2pos(gtime_t time, const eph_t* eph, double* rs, double* dts, double* var);

// The library asks its program for these.
int showmsg(const char* /*format*/, ...) {
  return 0;
}
void settspan(gtime_t /*start*/, gtime_t /*end*/) {}
void settime(gtime_t /*time*/) {}
}

namespace {

gtime_t time_of(std::int64_t ns) {
  constexpr std::int64_t kGpsEpochUnix_s = 315'964'800;
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {static_cast<time_t>(ns / kSecond + kGpsEpochUnix_s), static_cast<double>(ns % kSecond) / 1e9};
}

eph_t ephemeris(const std::array<double, 20>& v) {
  eph_t e{};
  e.A = v[0] * v[0];
  e.e = v[1];
  e.M0 = v[2];
  e.deln = v[3];
  e.OMG0 = v[4];
  e.OMGd = v[5];
  e.i0 = v[6];
  e.idot = v[7];
  e.omg = v[8];
  e.cuc = v[9];
  e.cus = v[10];
  e.cic = v[11];
  e.cis = v[12];
  e.crc = v[13];
  e.crs = v[14];
  e.toes = v[15];
  e.f0 = v[16];
  e.f1 = v[17];
  e.f2 = v[18];
  return e;
}

}  // namespace

int main() {
  int system = 0;
  int prn = 0;
  std::int64_t toe = 0;
  std::int64_t toc = 0;
  std::int64_t time = 0;
  while (std::scanf("%d %d %" SCNd64 " %" SCNd64 " %" SCNd64, &system, &prn, &toe, &toc, &time) == 5) {
    std::array<double, 20> elements{};
    for (double& element : elements) {
      if (std::scanf("%lf", &element) != 1) return 1;
    }
    eph_t eph = ephemeris(elements);
    eph.sat = satno(system, prn);
    eph.toe = time_of(toe);
    eph.toc = time_of(toc);
    std::array<double, 3> position{};
    double clock = 0.0;
    double variance = 0.0;
    eph2pos(time_of(time), &eph, position.data(), &clock, &variance);
    std::printf("%.17g %.17g %.17g %.17g\n", position[0], position[1], position[2], clock);
  }
  return 0;
}
