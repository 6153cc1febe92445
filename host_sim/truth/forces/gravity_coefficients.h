#pragma once
// Stokes coefficients of a gravity model, as read from a file.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
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

// The formats of gravity models that are read as published. Each is recognised by its contents; each has its functions
// here and its line in the list.

struct GravityFormat {
  std::string_view name;
  bool (*recognises)(std::string_view text);
  /// Reads the model up to `degree`. Throws files::FormatError, and std::invalid_argument for a degree that it lacks.
  GravityCoefficients (*read)(std::string_view text, const std::string& file, int degree);
};

// Table of this project (gravity_coefficients.h).
[[nodiscard]] bool is_gravity_table(std::string_view text);
[[nodiscard]] GravityCoefficients read_gravity_table(std::string_view text, const std::string& file, int degree);

// ICGEM .gfc, static models (Barthelmes, Foerste 2011, "The ICGEM-format"): every coefficient of the degrees asked for
// must be there from degree 2 on, and some of max_degree, in any order. Coefficients that are not normalised are
// normalised.
[[nodiscard]] bool is_icgem(std::string_view text);
[[nodiscard]] GravityCoefficients read_icgem(std::string_view text, const std::string& file, int degree);

[[nodiscard]] std::span<const GravityFormat> gravity_formats();

/// Reads the model of a text in any of the formats, up to `degree`. Throws files::FormatError; for an unknown format it
/// names all; std::invalid_argument for a degree that the model lacks.
[[nodiscard]] GravityCoefficients read_gravity(std::string_view text, const std::string& file, int degree);

inline constexpr int kHighestDegree = 2190;  ///< degree of the largest published models: limits damaged headers

void check_degree(const std::string& file, int degree, int max_degree);

}  // namespace vbar::truth
