#pragma once
// Constants of the interface documents of the navigation satellites, shared by emulator and receiver software.

namespace vbar::fsw::gnss {

inline constexpr double kSpeedOfLight = 299792458.0;  ///< m/s

// Carriers: IS-GPS-200N 3.3.1.1; Galileo OS SIS ICD 2.1, table 2; BDS-SIS-ICD-B1I-3.0, 4.2.1.
inline constexpr double kL1_Hz = 1575.42e6;
inline constexpr double kL2_Hz = 1227.60e6;
inline constexpr double kE1_Hz = 1575.42e6;
inline constexpr double kB1I_Hz = 1561.098e6;

// Gravitational parameter, Earth rate and relativistic constant of each system's broadcast orbit model: IS-GPS-200N
// table 20-IV; Galileo OS SIS ICD 2.1, table 67; BDS-SIS-ICD-B1I-3.0, 5.2.4.12. m^3/s^2, rad/s, s/m^(1/2).
inline constexpr double kGmGps = 3.986005e14;
inline constexpr double kGmGalileo = 3.986004418e14;
inline constexpr double kGmBeidou = 3.986004418e14;
inline constexpr double kEarthRateGps = 7.2921151467e-5;
inline constexpr double kEarthRateGalileo = 7.2921151467e-5;
inline constexpr double kEarthRateBeidou = 7.2921150e-5;
inline constexpr double kRelativisticGps = -4.442807633e-10;
inline constexpr double kRelativisticGalileo = -4.442807309e-10;
inline constexpr double kRelativisticBeidou = -4.442807309e-10;

}  // namespace vbar::fsw::gnss
