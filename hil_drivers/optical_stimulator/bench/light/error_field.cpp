#include "hil_drivers/optical_stimulator/bench/light/error_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host_sim/engine/random_stream.h"

namespace vbar::optical_stimulator::bench {
namespace {

constexpr double kArcsec = std::numbers::pi / 648000.0;
constexpr int kMargin = 2;  ///< nodes before the first pixel and behind the last
constexpr int kLightWaves = 8;

struct Wave {
  double amplitude, k_u, k_v, phase;

  [[nodiscard]] double at(double u, double v) const { return amplitude * std::cos(k_u * u + k_v * v + phase); }
};

std::vector<Wave> draw_waves(engine::RandomStream stream, int count, double rms, double wave_number) {
  std::vector<Wave> waves;
  const double amplitude = rms * std::sqrt(2.0 / std::max(1, count));
  for (int k = 0; k < count; ++k) {
    const double k_u = wave_number * stream.normal();
    const double k_v = wave_number * stream.normal();
    waves.push_back({amplitude, k_u, k_v, stream.uniform(0.0, 2.0 * std::numbers::pi)});
  }
  return waves;
}

double sum(const std::vector<Wave>& waves, double u, double v) {
  double value = 0.0;
  for (const Wave& wave : waves) value += wave.at(u, v);
  return value;
}

/// Weights of the four nodes about a place `t` steps behind the second (Catmull and Rom 1974).
std::array<double, 4> spline(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t + 2.0 * t2 - t3), 0.5 * (2.0 - 5.0 * t2 + 3.0 * t3), 0.5 * (t + 4.0 * t2 - 3.0 * t3),
          0.5 * (t3 - t2)};
}

}  // namespace

ErrorField::ErrorField(const FieldSettings& settings, std::uint64_t seed, int width, int height)
    : columns_(width / kStep_px + 2 * kMargin + 2), rows_(height / kStep_px + 2 * kMargin + 2) {
  const double rms = settings.direction_arcsec * kArcsec;
  const auto x = draw_waves({seed, "bench/field/x"}, settings.waves, rms, 1.0 / settings.wave_length_px);
  const auto y = draw_waves({seed, "bench/field/y"}, settings.waves, rms, 1.0 / settings.wave_length_px);
  const auto light = draw_waves({seed, "bench/field/light"}, kLightWaves, settings.light, 2.0 / width);
  nodes_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const double u = kStep_px * (column - kMargin), v = kStep_px * (row - kMargin);
      nodes_.push_back({sum(x, u, v), sum(y, u, v), sum(light, u, v)});
    }
  }
}

FieldError ErrorField::at(double u, double v) const {
  const double c = std::clamp(u / kStep_px + kMargin, 1.0, columns_ - 2.001);
  const double r = std::clamp(v / kStep_px + kMargin, 1.0, rows_ - 2.001);
  const auto column = static_cast<std::size_t>(c), row = static_cast<std::size_t>(r);
  const auto wu = spline(c - static_cast<double>(column)), wv = spline(r - static_cast<double>(row));
  FieldError error;
  for (std::size_t j = 0; j < 4; ++j) {
    const FieldError* nodes = &nodes_[(row + j - 1) * static_cast<std::size_t>(columns_) + column - 1];
    FieldError line;
    for (std::size_t i = 0; i < 4; ++i) {
      line.x += wu[i] * nodes[i].x;
      line.y += wu[i] * nodes[i].y;
      line.light += wu[i] * nodes[i].light;
    }
    error.x += wv[j] * line.x;
    error.y += wv[j] * line.y;
    error.light += wv[j] * line.light;
  }
  return error;
}

}  // namespace vbar::optical_stimulator::bench
