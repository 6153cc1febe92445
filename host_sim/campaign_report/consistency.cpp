// Whether the filter's claims agree with its errors, over the cases at each selected time.

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host_sim/campaign_report/page.h"
#include "host_sim/campaign_report/quantity.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/plots/svg_plot.h"

namespace vbar::campaign_report {
namespace {

using report::Mark;
using report::Plot;
using report::Point;

constexpr std::size_t kMaxPoints = 6;  // points of the sweeps that are judged each by itself; more are judged together
constexpr const char* kTogether = "all points of the sweeps";

struct Test {
  const char* name;  ///< in the columns of results.csv
  const char* title;
  const char* mean;
};
constexpr std::array<Test, 2> kTests{Test{"nees", "NEES of the state", "ANEES"},
                                     Test{"nis", "NIS of the innovations", "mean NIS"}};

/// Cases that are judged together, and one test's epochs of them.
struct Judged {
  std::string name;  ///< name of the point of the sweeps
  const Test* test = nullptr;
  std::vector<Epoch> epochs;
};

std::vector<Judged> judged_groups(const Campaign& campaign) {
  std::vector<SweepPoint> groups = sweep_points(campaign);
  if (groups.size() > kMaxPoints) {
    groups.resize(1);
    groups.front().name = kTogether;
    groups.front().places.clear();
    for (std::size_t place = 0; place < campaign.cases.size(); ++place) groups.front().places.push_back(place);
  }
  std::vector<Judged> all;
  for (const Test& test : kTests)
    for (const SweepPoint& group : groups)
      if (auto epochs = epochs_of(campaign, test.name, group.places); !epochs.empty())
        all.push_back({group.name, &test, std::move(epochs)});
  return all;
}

/// Per dimension, so that epochs with different numbers of measurements share a scale.
Plot plot_of(const Judged& judged) {
  Plot plot;
  plot.title = fmt::format("{} per dimension{}{}", judged.test->mean, judged.name.empty() ? "" : ", ", judged.name);
  plot.x = {.name = "time", .unit = report::Unit::kHours};
  plot.y = {.name = std::string(judged.test->mean) + " per dimension"};
  plot.height = 240.0;
  std::vector<Point> inside, outside, mean, band, expected;
  for (const Epoch& epoch : judged.epochs) {
    const Point at{epoch.time_h, epoch.mean / epoch.mean_dimension};
    mean.push_back(at);
    (epoch.is_above() || epoch.is_below() ? outside : inside).push_back(at);
    band.push_back({epoch.time_h, epoch.band.low / epoch.mean_dimension});
    expected.push_back({epoch.time_h, 1.0});
  }
  for (auto epoch = judged.epochs.rbegin(); epoch != judged.epochs.rend(); ++epoch)
    band.push_back({epoch->time_h, epoch->band.high / epoch->mean_dimension});
  plot.series = {{"95 % band of a consistent filter", 2, Mark::kArea, std::move(band)},
                 {"", 2, Mark::kDashedLine, std::move(expected)},
                 {"", 0, Mark::kLine, std::move(mean)},
                 {"mean of the cases, inside the band", 0, Mark::kDots, std::move(inside)},
                 {"outside", 1, Mark::kDots, std::move(outside)}};
  return plot;
}

std::string p_text(double p) {
  return p < 1e-4 ? "< 0.0001" : fmt::format("{:.4f}", p);
}

/// A row for each group.
std::string verdict_table(const std::vector<Judged>& all) {
  std::vector<std::vector<std::string>> rows;
  for (const Judged& judged : all) {
    const Consistency found = consistency_of(judged.epochs);
    rows.push_back(
        {judged.test->title, judged.name.empty() ? "all cases" : judged.name,
         found.is_rejected ? R"(<span class="status bad">rejected</span>)"
                           : R"(<span class="status good">not rejected</span>)",
         report::grouped(found.epochs),
         fmt::format("{} ({:.0f} %)", found.epochs - found.above - found.below, 100.0 * found.share_inside()),
         report::grouped(found.above), report::grouped(found.below), p_text(found.p_value)});
  }
  return report::table({{"", false},
                        {"", false},
                        {"filter", false, true},
                        {"epochs"},
                        {"inside the band"},
                        {"above"},
                        {"below"},
                        {"p, corrected"}},
                       rows);
}

/// Returns the table of the epochs at which the filter is not consistent.
std::string outside_table(const std::vector<Judged>& all) {
  constexpr std::size_t kMaxRows = 200;
  std::vector<std::vector<std::string>> rows;
  for (const Judged& judged : all) {
    for (const Epoch& epoch : judged.epochs) {
      if (!epoch.is_above() && !epoch.is_below()) continue;
      rows.push_back({judged.test->title, judged.name.empty() ? "all cases" : judged.name,
                      epoch.is_above() ? "above" : "below", fmt::format("{:g}", epoch.time_h),
                      report::grouped(epoch.cases), report::fixed(epoch.mean_dimension, 2),
                      report::fixed(epoch.mean, 3),
                      fmt::format("{} to {}", report::fixed(epoch.band.low, 3), report::fixed(epoch.band.high, 3)),
                      p_text(epoch.p_value)});
    }
  }
  if (rows.empty()) return {};
  const std::size_t count = rows.size();
  rows.resize(std::min(count, kMaxRows));
  return fmt::format("<details><summary>{} outside the band{}</summary>\n", count_text(count, "epoch", "epochs"),
                     count > kMaxRows ? fmt::format(", the first {}", kMaxRows) : "") +
         report::table({{"", false},
                        {"", false},
                        {"", false},
                        {"time, h"},
                        {"cases"},
                        {"expected"},
                        {"mean"},
                        {"95 % band"},
                        {"p"}},
                       rows) +
         "</details>\n";
}

std::string notes(const Campaign& campaign, const std::vector<Judged>& all) {
  std::string text =
      "<p class=\"note\">At each time the mean over complete cases is compared with the chi-square distribution of its "
      "sum. A filter is rejected if one epoch would occur in less than 5 % of the campaigns of a consistent filter, "
      "after "
      "correction for the number of epochs; this holds whatever the correlation of its epochs in time. About 5 % of "
      "the "
      "epochs of a consistent filter are outside their bands.";
  if (all.front().name == kTogether && share_seeds(campaign))
    text += " Points of the sweeps share seeds, so that the bands are approximate.";
  text += "</p>\n";
  std::string missing;
  for (const double time_h : missing_samples(campaign))
    missing += fmt::format("{}{:g}", missing.empty() ? "" : ", ", time_h);
  if (!missing.empty())
    text += fmt::format("<p><span class=\"bad\">No case has figures at {} h.</span></p>\n", missing);
  return text;
}

}  // namespace

report::Section consistency_section(const Content& content) {
  const std::vector<Judged> all = judged_groups(content.campaign);
  if (all.empty()) return {};
  const std::string body = notes(content.campaign, all) + verdict_table(all);
  std::vector<Plot> plots;
  for (const Judged& judged : all)
    if (judged.epochs.size() > 1) plots.push_back(plot_of(judged));
  return {
      "Consistency of the filter", body + report::plot_rows(2, std::move(plots)) + outside_table(all), {"results.csv"}};
}

}  // namespace vbar::campaign_report
