#include "host_sim/report/plots/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/report/plots/html_page.h"

namespace vbar::report {

namespace {

constexpr double kTitleHeight = 22.0;
constexpr double kMomentTextHeight = 12.0;
constexpr double kRightMargin = 12.0;
constexpr double kBottomMargin = 42.0;
constexpr double kCharacterWidth = 7.2;  // width in the tick font, in print
constexpr double kEventHeight = 9.0;
constexpr double kCurveTolerance = 0.25;  // pixels
constexpr double kDotDistance = 1.0;      // pixels
constexpr double kCellDistance = 7.0;     // pixels, of the centres of hexagonal cells
constexpr std::size_t kMostDots = 600;    // dots of a kDensity series; more are drawn as cells
constexpr int kShades = 5;                // shades of the cells
constexpr double kPageWidth = 1190.0;     // pixels, of a row of plots on a wide screen
constexpr double kGap = 16.0;             // between the plots of a row

bool finite(const Point& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

bool is_dots(const Series& series) {
  return series.mark == Mark::kDots || series.mark == Mark::kBroadDots || series.mark == Mark::kDensity;
}

std::string_view style_of(const Series& series) {
  switch (series.mark) {
    case Mark::kBroadLine:
    case Mark::kBroadDots:
      return "broad ";
    case Mark::kDashedLine:
      return "dashed ";
    default:
      return "";
  }
}

std::vector<double> values_of(const Plot& plot, double Point::*coordinate, bool positive_only) {
  std::vector<double> values;
  const auto take = [&](const Point& p) {
    if (finite(p) && (!positive_only || p.*coordinate > 0.0)) values.push_back(p.*coordinate);
  };
  for (const Series& series : plot.series) std::ranges::for_each(series.points, take);
  for (const Ring& ring : plot.rings) take(ring.at);
  return values;
}

/// An axis with its range settled, in the units it shows.
struct Scale {
  Range range;
  DisplayUnit unit;
  Unit quantity = Unit::kNone;
  bool logarithmic = false;
  double start = 0.0, length = 0.0;  // pixels; a negative length runs upwards

  [[nodiscard]] bool shows(double si) const { return !logarithmic || si > 0.0; }
  [[nodiscard]] double pixel(double si) const { return pixel_of_shown(si * unit.per_si); }
  [[nodiscard]] double pixel_of_shown(double shown) const {
    const double fraction = logarithmic ? std::log(shown / range.low) / std::log(range.high / range.low)
                                        : (shown - range.low) / range.span();
    return start + length * fraction;
  }
};

Range settled_range(const Axis& axis, const std::vector<double>& values) {
  if (axis.range) return *axis.range;
  const auto found = range_of(values);
  if (!found) return {axis.logarithmic ? 0.1 : 0.0, 1.0};
  if (axis.logarithmic) return {found->low / 1.3, found->high * 1.3};
  return padded(*found, axis.min_span);
}

void set_unit(Scale& scale, const DisplayUnit& unit) {
  scale.unit = unit;
  scale.range = {scale.range.low * unit.per_si, scale.range.high * unit.per_si};
}

/// The size of the numbers that an axis writes: the largest, or the middle one of decades.
double typical_size(const Scale& scale) {
  if (scale.logarithmic) return std::sqrt(scale.range.low * scale.range.high);
  return std::max(std::abs(scale.range.low), std::abs(scale.range.high));
}

/// Widens the axis that shows fewer metres a pixel.
void make_same_scale(Scale& x, Scale& y) {
  const double per_pixel_x = x.range.span() / std::abs(x.length);
  const double per_pixel_y = y.range.span() / std::abs(y.length);
  Scale& narrow = per_pixel_x < per_pixel_y ? x : y;
  const double half = 0.5 * std::max(per_pixel_x, per_pixel_y) * std::abs(narrow.length);
  narrow.range = {narrow.range.centre() - half, narrow.range.centre() + half};
}

/// From kilometres to millimetres each tick states its own unit, and the axis none.
bool writes_units(const Scale& scale) {
  if (!scale.logarithmic || (scale.quantity != Unit::kMetres && scale.quantity != Unit::kMetresPerSecond)) return false;
  const auto unit_at = [&](double shown) { return display_unit(scale.quantity, shown / scale.unit.per_si).symbol; };
  return scale.range.high / scale.range.low > 1e3 && unit_at(scale.range.low) != unit_at(scale.range.high);
}

std::vector<Tick> ticks_of(const Scale& scale, double pixels_a_tick) {
  const int count = std::max(2, static_cast<int>(std::abs(scale.length) / pixels_a_tick));
  const bool decades = scale.logarithmic && scale.range.high / scale.range.low > 10.0;
  std::vector<Tick> ticks = decades ? decade_ticks(scale.range, count) : linear_ticks(scale.range, count);
  if (writes_units(scale))
    for (Tick& tick : ticks) {
      const double si = tick.value / scale.unit.per_si;
      const DisplayUnit unit = display_unit(scale.quantity, si);
      tick.text = fmt::format("{:g} {}", unit.per_si * si, unit.symbol);
    }
  return ticks;
}

/// Draws one plot: `out` grows by an element at a time.
class Drawing {
 public:
  explicit Drawing(const Plot& plot)
      : plot_(plot), top_(kTitleHeight + (plot.moments.empty() ? 0.0 : kMomentTextHeight)) {
    settle_scales();
  }

  std::string draw() {
    append(R"(<svg class="plot" viewBox="0 0 {:g} {:g}" role="img"><title>{}</title>)", plot_.width, plot_.height,
           escaped(plot_.title));
    append(R"(<text class="title" x="2" y="13">{}</text>)", escaped(plot_.title));
    draw_grid();
    draw_axis_names();
    draw_moments();
    append(
        R"(<svg x="{0:.1f}" y="{1:.1f}" width="{2:.1f}" height="{3:.1f}" viewBox="{0:.1f} {1:.1f} {2:.1f} {3:.1f}">)",
        left_, top_, x_.length, -y_.length);
    draw_events();
    for (const Series& series : plot_.series) draw_series(series);
    out_ += "</svg>";
    for (const Ring& ring : plot_.rings) draw_ring(ring);
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  template <class... Arguments>
  void append(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Arguments>(arguments)...);
  }

  // The y axis first: the left margin depends on how wide its tick labels are.
  void settle_scales() {
    x_.range = settled_range(plot_.x, values_of(plot_, &Point::x, plot_.x.logarithmic));
    y_.range = settled_range(plot_.y, values_of(plot_, &Point::y, plot_.y.logarithmic));
    x_.quantity = plot_.x.unit;
    y_.quantity = plot_.y.unit;
    x_.logarithmic = plot_.x.logarithmic;
    y_.logarithmic = plot_.y.logarithmic;
    y_.start = plot_.height - kBottomMargin;
    y_.length = top_ - y_.start;
    const double both = std::max(typical_size(x_), typical_size(y_));
    set_unit(x_, display_unit(plot_.x.unit, plot_.same_scale ? both : typical_size(x_)));
    set_unit(y_, display_unit(plot_.y.unit, plot_.same_scale ? both : typical_size(y_)));

    settle_left_margin();
    if (!plot_.same_scale) return;
    make_same_scale(x_, y_);
    settle_left_margin();
  }

  void settle_left_margin() {
    std::size_t widest = 1;
    for (const Tick& tick : ticks_of(y_, 34.0)) widest = std::max(widest, tick.text.size());
    left_ = 26.0 + kCharacterWidth * static_cast<double>(widest);
    x_.start = left_;
    x_.length = plot_.width - kRightMargin - left_;
  }

  void draw_grid() {
    append(R"(<rect class="frame" x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/>)", left_, top_, x_.length,
           -y_.length);
    for (const Tick& tick : ticks_of(x_, 70.0)) {
      const double x = x_.pixel_of_shown(tick.value);
      append(R"(<line class="grid" x1="{0:.1f}" x2="{0:.1f}" y1="{1:.1f}" y2="{2:.1f}"/>)", x, top_, y_.start);
      const double half = 0.5 * kCharacterWidth * static_cast<double>(tick.text.size());
      append(R"(<text class="tick mid" x="{:.1f}" y="{:.1f}">{}</text>)", std::min(x, plot_.width - half),
             y_.start + 14.0, tick.text);
    }
    for (const Tick& tick : ticks_of(y_, 34.0)) {
      const double y = y_.pixel_of_shown(tick.value);
      append(R"(<line class="grid" x1="{1:.1f}" x2="{2:.1f}" y1="{0:.1f}" y2="{0:.1f}"/>)", y, left_,
             left_ + x_.length);
      append(R"(<text class="tick end" x="{:.1f}" y="{:.1f}">{}</text>)", left_ - 5.0, y + 3.5, tick.text);
    }
  }

  static std::string axis_text(const Axis& axis, const Scale& scale) {
    if (scale.unit.symbol.empty() || writes_units(scale)) return escaped(axis.name);
    return fmt::format("{}, {}", escaped(axis.name), scale.unit.symbol);
  }

  void draw_axis_names() {
    append(R"(<text class="name mid" x="{:.1f}" y="{:.1f}">{}</text>)", left_ + 0.5 * x_.length, plot_.height - 10.0,
           axis_text(plot_.x, x_));
    const double centre = y_.start + 0.5 * y_.length;
    append(R"svg(<text class="name mid" transform="translate(11 {:.1f}) rotate(-90)">{}</text>)svg", centre,
           axis_text(plot_.y, y_));
  }

  // A line for each; a text only where it has room.
  void draw_moments() {
    double free_from = 0.0;
    for (const Moment& moment : plot_.moments) {
      const double x = x_.pixel(moment.x);
      if (!(x >= left_ && x <= left_ + x_.length)) continue;
      append(R"(<line class="moment" x1="{0:.1f}" x2="{0:.1f}" y1="{1:.1f}" y2="{2:.1f}"/>)", x, top_, y_.start);
      const double half = 0.5 * kCharacterWidth * static_cast<double>(moment.text.size());
      const double centre = std::max(half, std::min(x, plot_.width - half));  // a long text at the edge stays whole
      if (centre - half < free_from) continue;
      append(R"(<text class="moment mid" x="{:.1f}" y="{:.1f}">{}</text>)", centre, top_ - 4.0, escaped(moment.text));
      free_from = centre + half + 3.0;
    }
  }

  void draw_events() {
    if (plot_.events.empty()) return;
    out_ += R"(<path class="event" d=")";
    for (const double event : plot_.events) {
      const double x = x_.pixel(event);
      if (x >= left_ && x <= left_ + x_.length) append("M{:.1f} {:.1f}v{:g}", x, y_.start, -kEventHeight);
    }
    out_ += "\"/>";
  }

  void draw_series(const Series& series) {
    std::vector<Point> stretch;
    const auto end_stretch = [&] {
      if (!stretch.empty()) draw_stretch(series, stretch);
      stretch.clear();
    };
    for (const Point& p : series.points) {
      const bool is_shown = finite(p) && x_.shows(p.x) && y_.shows(p.y);
      const Point pixel = is_shown ? Point{x_.pixel(p.x), y_.pixel(p.y)} : Point{};
      if (is_shown && finite(pixel)) {
        stretch.push_back(pixel);
      } else {
        end_stretch();
      }
    }
    end_stretch();
  }

  [[nodiscard]] Box frame() const { return {left_, top_, left_ + x_.length, y_.start}; }

  /// The polygon, clamped to the frame.
  void draw_area(const Series& series, const std::vector<Point>& pixels) {
    append(R"(<path class="area f{}" d=")", series.colour);
    char command = 'M';
    for (const Point& p : pixels) {
      append("{}{:.1f} {:.1f}", command, std::clamp(p.x, frame().left, frame().right),
             std::clamp(p.y, frame().top, frame().bottom));
      command = 'L';
    }
    out_ += "Z\"/>";
  }

  /// A path for each shade; shades are of the logarithm of the count.
  void draw_cells(const Series& series, const std::vector<Point>& inside) {
    const std::vector<Cell> cells = hexagonal_cells(inside, kCellDistance);
    std::size_t largest = 1;
    for (const Cell& cell : cells) largest = std::max(largest, cell.count);
    const auto shade_of = [&](const Cell& cell) {
      const double share = std::log(static_cast<double>(cell.count)) / std::log(static_cast<double>(largest) + 0.5);
      return static_cast<int>(share * kShades);
    };
    for (int shade = 0; shade < kShades; ++shade) {
      std::string path;
      for (const Cell& cell : cells) {
        if (shade_of(cell) == shade && frame().holds(cell.centre))
          fmt::format_to(std::back_inserter(path), "M{:.1f} {:.1f}h0", cell.centre.x, cell.centre.y);
      }
      if (!path.empty()) append(R"(<path class="dots cells s{} c{}" d="{}"/>)", shade, series.colour, path);
    }
  }

  void draw_stretch(const Series& series, const std::vector<Point>& pixels) {
    if (series.mark == Mark::kArea) {
      draw_area(series, pixels);
    } else if (is_dots(series) || pixels.size() == 1) {
      std::vector<Point> inside;
      std::ranges::copy_if(pixels, std::back_inserter(inside), [&](const Point& p) { return frame().holds(p); });
      if (inside.empty()) return;
      if (series.mark == Mark::kDensity && inside.size() > kMostDots) {
        draw_cells(series, inside);
        return;
      }
      append(R"(<path class="dots {}c{}" d=")", style_of(series), series.colour);
      // A line of no length with round ends is a dot: far shorter than a circle each.
      for (const Point& p : thinned_dots(inside, kDotDistance)) append("M{:.1f} {:.1f}h0", p.x, p.y);
    } else {
      const auto pieces = clipped(series.mark == Mark::kStairs ? stairs(pixels) : pixels, frame());
      if (pieces.empty()) return;
      append(R"(<path class="line {}c{}" d=")", style_of(series), series.colour);
      for (const std::vector<Point>& piece : pieces) {
        char command = 'M';
        for (const Point& p : thinned_curve(piece, kCurveTolerance)) {
          append("{}{:.1f} {:.1f}", command, p.x, p.y);
          command = 'L';
        }
      }
    }
    out_ += "\"/>";
  }

  void draw_ring(const Ring& ring) {
    if (!finite(ring.at) || !x_.shows(ring.at.x) || !y_.shows(ring.at.y)) return;
    const Point at{x_.pixel(ring.at.x), y_.pixel(ring.at.y)};
    if (!frame().holds(at)) return;
    append(R"(<circle class="ring" cx="{:.1f}" cy="{:.1f}" r="3.5"><title>{}</title></circle>)", at.x, at.y,
           escaped(ring.tooltip));
    const Point text{at.x + 6.0, at.y - 5.0};
    const bool crowded = std::ranges::any_of(
        ring_texts_, [&](const Point& t) { return std::abs(t.x - text.x) < 15.0 && std::abs(t.y - text.y) < 11.0; });
    if (crowded) return;
    ring_texts_.push_back(text);
    append(R"(<text class="ring" x="{:.1f}" y="{:.1f}">{}</text>)", text.x, text.y, escaped(ring.text));
  }

  const Plot& plot_;
  Scale x_, y_;
  double top_ = 0.0, left_ = 0.0;  // corner of the frame
  std::string out_;
  std::vector<Point> ring_texts_;
};

std::string swatch(const Series& series) {
  if (series.mark == Mark::kArea)
    return fmt::format(R"(<svg class="swatch" viewBox="0 0 24 10"><path class="area f{}" d="M1 1H23V9H1Z"/></svg>)",
                       series.colour);
  return fmt::format(R"(<svg class="swatch" viewBox="0 0 24 10"><path class="{} {}c{}" d="{}"/></svg>)",
                     is_dots(series) ? "dots" : "line", style_of(series), series.colour,
                     is_dots(series) ? "M6 5h0M12 5h0M18 5h0" : "M1 5H23");
}

bool has_something(const Plot& plot, const Series& series) {
  return std::ranges::any_of(series.points, [&](const Point& p) {
    return finite(p) && (!plot.x.logarithmic || p.x > 0.0) && (!plot.y.logarithmic || p.y > 0.0);
  });
}

}  // namespace

std::string svg(const Plot& plot) {
  return Drawing(plot).draw();
}

std::string legend(const std::vector<Plot>& plots, std::size_t least) {
  std::vector<std::string> entries;
  for (const Plot& plot : plots) {
    for (const Series& series : plot.series) {
      if (series.name.empty() || !has_something(plot, series)) continue;
      std::string entry = fmt::format("<span>{}{}</span>", swatch(series), escaped(series.name));
      if (std::ranges::find(entries, entry) == entries.end()) entries.push_back(std::move(entry));
    }
  }
  if (entries.size() < least) return {};
  return fmt::format("<p class=\"legend\">{}</p>\n", fmt::join(entries, ""));
}

std::string plot_rows(int columns, std::vector<Plot> plots, std::size_t least_legend) {
  if (plots.empty()) return {};
  const int shared = std::min(columns, static_cast<int>(plots.size()));
  std::vector<std::string> drawn;
  for (Plot& plot : plots) {
    plot.width = std::floor((kPageWidth - kGap * (shared - 1)) / shared);
    drawn.push_back(svg(plot));
  }
  // Inside the first row, from which a page break would part it.
  std::string out = figures(shared, drawn);
  out.insert(out.find('\n') + 1, legend(plots, least_legend));
  return out;
}

namespace {

constexpr double kWidth = 1190.0;
constexpr double kLeft = 130.0;
constexpr double kRight = 12.0;
constexpr double kTop = 6.0;
constexpr double kRowHeight = 24.0;
constexpr double kBottom = 40.0;
constexpr double kLeastBand = 1.2;  // pixels: a single step of a long run can still be seen
constexpr double kLabelCharacterWidth = 6.0;

}  // namespace

std::string timeline(const std::vector<TimelineRow>& rows, const Range& hours) {
  const double bottom = kTop + kRowHeight * static_cast<double>(rows.size());
  const double plot_width = kWidth - kLeft - kRight;
  const auto pixel = [&](double h) { return kLeft + plot_width * (h - hours.low) / hours.span(); };

  std::string out = fmt::format(R"(<svg class="plot" viewBox="0 0 {:g} {:g}" role="img">)", kWidth, bottom + kBottom);
  const auto append = std::back_inserter(out);
  for (const Tick& tick : linear_ticks(hours, 16)) {
    fmt::format_to(append, R"(<line class="grid" x1="{0:.1f}" x2="{0:.1f}" y1="{1:g}" y2="{2:g}"/>)", pixel(tick.value),
                   kTop, bottom);
    fmt::format_to(append, R"(<text class="tick mid" x="{:.1f}" y="{:g}">{}</text>)", pixel(tick.value), bottom + 14.0,
                   tick.text);
  }
  fmt::format_to(append, R"(<text class="name mid" x="{:.1f}" y="{:g}">time, h</text>)", kLeft + 0.5 * plot_width,
                 bottom + 32.0);
  double y = kTop;
  for (const TimelineRow& row : rows) {
    fmt::format_to(append, R"(<text class="tick end" x="{:g}" y="{:g}">{}</text>)", kLeft - 8.0, y + 16.0,
                   escaped(row.name));
    for (const Band& band : row.bands) {
      const double width = std::max(kLeastBand, pixel(band.end_h) - pixel(band.start_h));
      fmt::format_to(append,
                     R"(<rect class="f{}" fill-opacity="0.6" x="{:.1f}" y="{:g}" width="{:.1f}" height="{:g}">)"
                     "<title>{}, {:.2f} h to {:.2f} h</title></rect>",
                     band.colour, pixel(band.start_h), y + 3.0, width, kRowHeight - 6.0, escaped(band.text),
                     band.start_h, band.end_h);
      if (width < kLabelCharacterWidth * static_cast<double>(band.text.size()) + 6.0) continue;
      fmt::format_to(append, R"(<text x="{:.1f}" y="{:g}">{}</text>)", pixel(band.start_h) + 4.0, y + 16.0,
                     escaped(band.text));
    }
    y += kRowHeight;
  }
  fmt::format_to(append, R"(<rect class="frame" x="{:g}" y="{:g}" width="{:g}" height="{:g}"/></svg>)", kLeft, kTop,
                 plot_width, bottom - kTop);
  return out;
}

}  // namespace vbar::report
