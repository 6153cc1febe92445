#include "host_sim/flown_gnss/comparison.h"

#include <utility>

#include <fmt/format.h>

namespace vbar::flown_gnss {
namespace {

constexpr std::size_t kFewestValues = 100;

class Figures {
 public:
  Figures(const FlownResult& flown, const FlownResult& twin) : flown_(flown), twin_(twin) {}

  template <class Figure>
  void add(const std::string& name, std::size_t count, const Figure& figure) {
    figures_.push_back({name, figure(flown_), figure(twin_), count});
  }

  /// `bins_of`: of a result; `scale`: from m to the unit of `name`.
  template <class BinsOf>
  void add_bins(const std::string& name, double scale, const BinsOf& bins_of) {
    for (std::size_t k = 0; k < kElevationBins; ++k) {
      const ElevationBin &flown = bins_of(flown_)[k], &twin = bins_of(twin_)[k];
      if (flown.count < kFewestValues || twin.count < kFewestValues) continue;
      const int from_deg = kFirstElevation_deg + kBinWidth_deg * static_cast<int>(k);
      figures_.push_back({fmt::format("{}, {} to {} deg", name, from_deg, from_deg + kBinWidth_deg),
                          scale * flown.sigma(), scale * twin.sigma(), flown.count});
    }
    const ElevationBin flown = sum_of(bins_of(flown_)), twin = sum_of(bins_of(twin_));
    figures_.push_back({name + ", all elevations", scale * flown.sigma(), scale * twin.sigma(), flown.count});
  }

  template <class CorrelationOf>
  void add_correlation(const std::string& name, double interval_s, const CorrelationOf& correlation_of) {
    const std::size_t count = correlation_of(flown_).pairs[0];
    for (const std::size_t lag : {1, 6, 30})
      add(fmt::format("{}, correlation after {:g} s", name, interval_s * static_cast<double>(lag)), count,
          [&](const FlownResult& result) { return correlation_of(result).at(lag); });
    add(name + ", correlation time beside white noise, s", count, [&](const FlownResult& result) {
      return interval_s * correlation_of(result).time_beside_white().value_or(0.0);
    });
  }

  [[nodiscard]] std::vector<ComparedFigure> take() { return std::move(figures_); }

 private:
  const FlownResult& flown_;
  const FlownResult& twin_;
  std::vector<ComparedFigure> figures_;
};

ErrorSums all_hours(const FlownResult& result) {
  return result.errors.of(0, result.errors.hours().size());
}

}  // namespace

std::vector<ComparedFigure> compare(const FlownResult& flown, const FlownResult& twin) {
  Figures figures(flown, twin);
  const std::size_t epochs = flown.epochs;
  figures.add("own orbit, m rms 3D", epochs, [](const FlownResult& r) { return all_hours(r).rms_m(); });
  figures.add("NEES of its position", epochs, [](const FlownResult& r) { return all_hours(r).mean_nees(); });
  figures.add("single points, m rms 3D", epochs, [](const FlownResult& r) { return all_hours(r).point_rms_m(); });
  figures.add("satellites of an epoch", epochs,
              [](const FlownResult& r) { return static_cast<double>(r.satellites) / static_cast<double>(r.epochs); });
  constexpr double kMillimetres = 1e3;
  figures.add_bins("range, m", 1.0, [](const FlownResult& r) -> const ElevationBins& { return r.ranges; });
  figures.add_bins("code L1, m", 1.0,
                   [](const FlownResult& r) -> const ElevationBins& { return r.signals.code_l1().bins; });
  figures.add_bins("code L2, m", 1.0,
                   [](const FlownResult& r) -> const ElevationBins& { return r.signals.code_l2().bins; });
  figures.add_bins("carriers, mm", kMillimetres,
                   [](const FlownResult& r) -> const ElevationBins& { return r.signals.carrier(); });
  const double interval_s = flown.signals.interval_s();
  const auto add_correlations = [&](const std::string& name, const auto& noise_of) {
    figures.add_correlation(name, interval_s,
                            [&](const FlownResult& r) -> const Correlation& { return noise_of(r).correlation; });
    figures.add_correlation(name + " above 30 deg", interval_s,
                            [&](const FlownResult& r) -> const Correlation& { return noise_of(r).high_correlation; });
  };
  add_correlations("code L1", [](const FlownResult& r) -> const SignalNoise& { return r.signals.code_l1(); });
  add_correlations("code L2", [](const FlownResult& r) -> const SignalNoise& { return r.signals.code_l2(); });
  return figures.take();
}

}  // namespace vbar::flown_gnss
