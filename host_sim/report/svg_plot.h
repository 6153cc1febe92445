#pragma once
// A plot as an SVG element that stands inside an HTML page. Colours and fonts come from the page's style sheet
// (html_page.h), so that it follows light, dark and print.

#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/plot_axis.h"
#include "host_sim/report/polyline.h"

namespace vbar::report {

enum class Mark { kLine, kBroadLine, kDashedLine, kStairs, kDots };

struct Series {
  std::string name;
  int colour = 0;  ///< of the page's palette, 0 to 5
  Mark mark = Mark::kLine;
  std::vector<Point> points{};  ///< a point that is not finite makes a gap
};

/// A place worth naming: a ring with a short text beside it, left out where it would cover another's.
struct Ring {
  Point at;
  std::string text;
  std::string tooltip;
};

/// A moment worth naming: a dashed line across the plot.
struct Moment {
  double x = 0.0;
  std::string text;
};

struct Axis {
  std::string name;
  Unit unit = Unit::kNone;
  std::optional<Range> range{};  ///< from the data unless given
  double least_span = 0.0;
  bool logarithmic = false;  ///< values that are not positive are left out
};

struct Plot {
  std::string title;
  Axis x, y;
  bool same_scale = false;  ///< a metre is as long on both axes
  std::vector<Series> series;
  std::vector<Ring> rings;
  std::vector<Moment> moments;
  std::vector<double> events;            ///< many of one kind: each a short stroke on the lower edge
  double width = 380.0, height = 250.0;  ///< pixels
};

[[nodiscard]] std::string svg(const Plot& plot);

/// What the marks of a plot mean, as HTML; empty for fewer than two series.
[[nodiscard]] std::string legend(const std::vector<Series>& series);

}  // namespace vbar::report
