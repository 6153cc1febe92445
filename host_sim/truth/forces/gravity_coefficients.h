#pragma once
// Stokes coefficients of a gravity model, as read from a file.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace vbar::truth {

/// Fully normalised coefficients (geodesy's 4-pi normalisation, no Condon-Shortley phase) of
/// U = GM/r sum (R/r)^n P_nm(sin latitude) (C_nm cos m longitude + S_nm sin m longitude).
struct GravityCoefficients {
  std::string model;
  std::string tide_system;  ///< "zero_tide": the permanent tide's deformation is in C20, its direct attraction is not
  double gm = 0.0;          ///< m^3/s^2
  double radius = 0.0;      ///< reference radius R, m
  int degree = 0;
  std::vector<double> c;  ///< at index(n, m), 0 <= m <= n <= degree
  std::vector<double> s;

  static std::size_t index(int n, int m) { return static_cast<std::size_t>(n) * (n + 1) / 2 + m; }

  /// Returns the coefficients of one degree and order, 0 if n is above the degree.
  double c_nm(int n, int m) const { return n <= degree ? c[index(n, m)] : 0.0; }
  double s_nm(int n, int m) const { return n <= degree ? s[index(n, m)] : 0.0; }
};

/// Reads the model up to `degree` from a file in any of gravity_formats(). That of data/gravity: '#' comments; lines
/// "model", "gm_m3ps2", "radius_m", "max_degree", "tide_system" with a value; "coefficients"; then "n m C S" for every
/// 0 <= m <= n <= max_degree in order; "end".
/// Throws std::runtime_error, naming file, line and what is expected, if the file is damaged or truncated (the whole
/// file is read whatever the degree asked), and std::invalid_argument if `degree` is negative or above the file's.
GravityCoefficients load_gravity_coefficients(const std::filesystem::path& file, int degree);

}  // namespace vbar::truth
