#include "host_sim/report/timeline.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"

namespace vbar::report {
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
