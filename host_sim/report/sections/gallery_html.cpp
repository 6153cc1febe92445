#include "host_sim/report/sections/gallery_html.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/plots/png.h"
#include "host_sim/report/words.h"

namespace vbar::report {
namespace {

/// `shape` is the element's name and geometry.
std::string mark(const MarkAt& at, double size, const std::string& shape, std::string_view element) {
  if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(size)) return {};
  return fmt::format(R"(<{0} class="mark {1}" {2}><title>{3}</title></{0}>)", element, at.colour, shape,
                     escaped(at.tooltip));
}

std::string picture(const GalleryImage& image, std::span<const std::uint8_t> png, const std::string& caption,
                    const std::string& marks) {
  const std::string uri = png_data_uri(png);
  if (image.width_px <= 0 || image.height_px <= 0) {
    return fmt::format(R"(<img class="picture" alt="{}" src="{}"/>)", escaped(caption), uri);
  }
  const int width = image.crop_side == 0 ? image.width_px : image.crop_left + image.crop_side;
  const int height = std::max(image.height_px, image.crop_side);
  return fmt::format(R"(<svg class="picture" viewBox="0 0 {0} {1}" role="img"><title>{2}</title>)"
                     R"(<image width="{0}" height="{1}" href="{3}"/>{4}</svg>)",
                     width, height, escaped(caption), uri, marks);
}

std::string with_caption(const std::string& picture, const std::string& caption) {
  return picture + fmt::format("<figcaption>{}</figcaption>", escaped(caption));
}

}  // namespace

std::string box_mark(const MarkAt& at, double half_side) {
  return mark(at, half_side,
              fmt::format(R"(x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}")", at.x - half_side, at.y - half_side,
                          2.0 * half_side, 2.0 * half_side),
              "rect");
}

std::string circle_mark(const MarkAt& at, double radius) {
  return mark(at, radius, fmt::format(R"(cx="{:.1f}" cy="{:.1f}" r="{:.1f}")", at.x, at.y, radius), "circle");
}

// Equilateral, its tip up.
std::string triangle_mark(const MarkAt& at, double inner_radius) {
  const double half_base = std::sqrt(3.0) * inner_radius;
  return mark(at, inner_radius,
              fmt::format(R"(d="M{:.1f} {:.1f}l{:.1f} {:.1f}h{:.1f}z")", at.x, at.y - 2.0 * inner_radius, half_base,
                          3.0 * inner_radius, -2.0 * half_base),
              "path");
}

std::string cross_mark(const MarkAt& at, double half_size) {
  return mark(at, half_size,
              fmt::format(R"(d="M{:.1f} {:.1f}h{:.1f}M{:.1f} {:.1f}v{:.1f}")", at.x - half_size, at.y, 2.0 * half_size,
                          at.x, at.y - half_size, 2.0 * half_size),
              "path");
}

// Semi-axes are roots of the eigenvalues.
std::string ellipse_mark(const MarkAt& at, const Triple& covariance, double sigmas) {
  const auto [xx, xy, yy] = covariance;
  if (!(xx > 0.0) || !(xx * yy - xy * xy > 0.0)) return {};
  const double mean = 0.5 * (xx + yy), deviation = std::hypot(0.5 * (xx - yy), xy);
  const double major = sigmas * std::sqrt(mean + deviation);
  const double minor = sigmas * std::sqrt(std::max(mean - deviation, 0.0));
  const double angle_deg = 90.0 / M_PI * std::atan2(2.0 * xy, xx - yy);
  return mark(at, major,
              fmt::format(R"svg(rx="{:.1f}" ry="{:.1f}" transform="translate({:.1f} {:.1f}) rotate({:.1f})")svg", major,
                          minor, at.x, at.y, angle_deg),
              "ellipse");
}

std::string gallery_html(const RunRecord& record, int columns, const std::string& note,
                         const std::function<std::string(const GalleryImage&)>& marks) {
  if (record.gallery.empty()) return {};
  std::vector<std::string> pictures;
  for (const GalleryImage& image : record.gallery) {
    const std::string name = fmt::format("image {} at {} h", image.image, fixed(image.time_s / 3600.0, 2));
    const bool has_twin = !image.difference.empty();
    const std::string caption =
        name + (has_twin ? ", " + loop_name(record.summary) : std::string()) + ": " + image.caption;
    pictures.push_back(with_caption(picture(image, image.png, caption, marks(image)), caption));
    if (!has_twin) continue;
    const std::string twin = name + ", SIL: the digital twin's image of the same exposure";
    pictures.push_back(with_caption(picture(image, image.twin_png, twin, ""), twin));
    const std::string difference = name + ", HIL less SIL: " + image.difference;
    pictures.push_back(with_caption(picture(image, image.difference_png, difference, ""), difference));
  }
  return "<h3>Images</h3>\n<p class=\"note\">" + note + "</p>\n" + figures(columns, pictures);
}

}  // namespace vbar::report
