#pragma once
// The formats of gravity models that are read as published. Each is recognised by its contents; each has its functions
// here and its line in the list.

#include <span>
#include <string>
#include <string_view>

#include "host_sim/truth/forces/gravity_coefficients.h"

namespace vbar::truth {

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
