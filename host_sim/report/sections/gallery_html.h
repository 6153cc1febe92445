#pragma once
// The pictures of a run's gallery inside a page, with marks about what was found in them drawn over them as SVG.

#include <functional>
#include <string>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// Shapes of marks in coordinates of the picture; the tooltip is text. Empty where a coordinate is not finite.
struct MarkAt {
  double x = 0.0, y = 0.0;
  const char* colour = "red";  ///< class of the style sheet: red, green, blue, white
  std::string tooltip{};
};
[[nodiscard]] std::string box_mark(const MarkAt& at, double half_side);
[[nodiscard]] std::string circle_mark(const MarkAt& at, double radius);
[[nodiscard]] std::string triangle_mark(const MarkAt& at, double inner_radius);
[[nodiscard]] std::string cross_mark(const MarkAt& at, double half_size);
/// `sigmas` of a covariance [xx, xy, yy]; empty for one that is not positive definite.
[[nodiscard]] std::string ellipse_mark(const MarkAt& at, const Triple& covariance, double sigmas);

/// A pixel of the detector in the picture. An integer is the centre of a pixel there and a corner here.
[[nodiscard]] inline double in_picture(double pixel, int first_pixel) {
  return pixel - first_pixel + 0.5;
}

/// All pictures with their captions, `columns` a row, below a heading and a note; empty without pictures. `marks` gives
/// the marks of a picture; those of folders without a region are shown as they are, since their marks are in the
/// pixels. An image of a testbed is followed by the image of the digital twin and their difference, so that with three
/// columns a row is one exposure.
[[nodiscard]] std::string gallery_html(const RunRecord& record, int columns, const std::string& note,
                                       const std::function<std::string(const GalleryImage&)>& marks);

}  // namespace vbar::report
