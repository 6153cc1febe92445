#pragma once
// The published coefficients of NRLMSISE-00 (Picone, Hedin, Drob, Aikin 2002), as read from a file. The arrays keep the
// names, order and units (km, K, cm^-3) of the publication, so that each can be found there.

#include <array>
#include <filesystem>

namespace vbar::truth {

struct Nrlmsise00Tables {
  /// Coefficients of the expansion of one quantity of the thermosphere, and of one below 120 km.
  using Upper = std::array<double, 150>;
  using Lower = std::array<double, 100>;

  Upper pt{};                                   ///< exospheric temperature
  std::array<Upper, 9> pd{};                    ///< at 120 km: He, O, N2, temperature, O2, Ar, H, N, anomalous O
  Upper ps{};                                   ///< temperature gradient at 120 km
  std::array<std::array<double, 25>, 2> pdl{};  ///< turbopause, factors of the composition's corrections
  std::array<double, 10> ptm{};                 ///< mean temperatures and the heights they belong to
  std::array<std::array<double, 10>, 8> pdm{};  ///< He, O, N2, O2, Ar, H, N, anomalous O: density at 120 km, mixing ...
  std::array<Lower, 4> ptl{};                   ///< temperature at 110, 100, 90, 72.5 km
  std::array<Lower, 10> pma{};                  ///< temperature at 55 ... 0 km, gradients at the joints
  std::array<double, 10> pavgm{};               ///< mean temperatures below 72.5 km
};

/// Reads data/atmosphere/nrlmsise00.csv: '#' comments; for each array above, in this order, "array,NAME,ROWS,COLUMNS"
/// and its rows of numbers; "end". Throws std::runtime_error, naming file, line, what was found and what is expected,
/// if the file is missing, damaged or truncated.
Nrlmsise00Tables load_nrlmsise00_tables(const std::filesystem::path& file);

}  // namespace vbar::truth
