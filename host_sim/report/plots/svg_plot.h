#pragma once
// A plot as an SVG element that stands inside an HTML page. Colours and fonts come from the page's style sheet
// (html_page.h), so that it follows light, dark and print.

#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/plots/plot_axis.h"

namespace vbar::report {

/// Broad ones are translucent: another series drawn over them leaves them visible. kArea fills the polygon of the
/// points; kDensity draws dots, or, of many points, hexagonal cells that are darker the more points they hold.
enum class Mark { kLine, kBroadLine, kDashedLine, kStairs, kDots, kBroadDots, kArea, kDensity };

struct Series {
  std::string name;
  int colour = 0;  ///< index in the page's palette, 0 to 5
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
  double min_span = 0.0;
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
  double width = 386.0, height = 250.0;  ///< pixels
};

[[nodiscard]] std::string svg(const Plot& plot);

/// The marks of all plots with their names, each once, as HTML: of named series that have something to show. Empty for
/// fewer than `least` points.
[[nodiscard]] std::string legend(const std::vector<Plot>& plots, std::size_t least = 2);

/// Plots side by side below their legend, `columns` a row. Their widths are set so that text has the same size whatever
/// the number of columns; plots too few for a row share its width.
[[nodiscard]] std::string plot_rows(int columns, std::vector<Plot> plots, std::size_t least_legend = 2);

// Bands on rows over time, as SVG inside a page: what happened when.

struct Band {
  double start_h = 0.0, end_h = 0.0;
  int colour = 0;      ///< index in the page's palette, 0 to 5; 6 warns
  std::string text{};  ///< written inside where it has room, and shown on pointing at it
};

struct TimelineRow {
  std::string name;
  std::vector<Band> bands;
};

[[nodiscard]] std::string timeline(const std::vector<TimelineRow>& rows, const Range& hours);

}  // namespace vbar::report
