#include "hil_drivers/tron/calibration/corner_detection.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace vbar::tron::calibrate {
namespace {

using cv::Mat;
using cv::Point2f;

/// The whole range of the image's light between its 0.5 and 99.5 %.
Mat stretched(const GrayImage& image, int type) {
  std::vector<std::uint16_t> sample;
  for (std::size_t k = 0; k < image.pixels.size(); k += 37) sample.push_back(image.pixels[k]);
  const auto at = [&](double share) {
    const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sample.size() - 1));
    std::ranges::nth_element(sample, middle);
    return static_cast<double>(*middle);
  };
  const double low = at(0.005), high = std::max(low + 1.0, at(0.995));
  // OpenCV takes no constant pixels, and does not write to these.
  const Mat raw(image.height, image.width, CV_16UC1, const_cast<std::uint16_t*>(image.pixels.data()));
  Mat result;
  raw.convertTo(result, type, 255.0 / (high - low), -low * 255.0 / (high - low));
  return result;
}

cv::Ptr<cv::aruco::CharucoBoard> charuco_board(const BoardDesign& board) {
  return cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square_m),
                                         static_cast<float>(board.marker_m),
                                         cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50));
}

/// Side of a square in the image, from the shortest sides of the markers.
double square_px(const std::vector<std::vector<Point2f>>& markers, const BoardDesign& board) {
  std::vector<double> sides;
  for (const auto& marker : markers) {
    double side = 1e9;
    for (std::size_t k = 0; k < 4; ++k) side = std::min(side, cv::norm(marker[k] - marker[(k + 1) % 4]));
    sides.push_back(side);
  }
  const auto middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
  std::ranges::nth_element(sides, middle);
  return *middle * board.square_m / board.marker_m;
}

/// Corners that a homography of the plane leaves within `outlier_px`.
std::vector<Corner> on_a_plane(const std::vector<Corner>& corners, const BoardDesign& board, double outlier_px) {
  if (corners.size() < 6) return {};
  std::vector<Point2f> plane, seen;
  for (const Corner& corner : corners) {
    const fsw::Vector3 point = board.corner(corner.id);
    plane.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()));
    seen.emplace_back(static_cast<float>(corner.px.x()), static_cast<float>(corner.px.y()));
  }
  Mat used;
  const Mat homography = cv::findHomography(plane, seen, cv::RANSAC, outlier_px, used, 500, 0.999);
  if (homography.empty()) return {};
  std::vector<Corner> kept;
  for (std::size_t k = 0; k < corners.size(); ++k)
    if (used.at<unsigned char>(static_cast<int>(k)) != 0) kept.push_back(corners[k]);
  return kept;
}

}  // namespace

std::vector<Corner> detect_corners(const GrayImage& image, const BoardDesign& board,
                                   const DetectionSettings& settings) {
  if (image.width < 16 || image.height < 16 ||
      image.pixels.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    throw std::invalid_argument("an image of the board whose size is not that of its pixels");
  const Mat eight = stretched(image, CV_8UC1);
  const auto charuco = charuco_board(board);
  const auto parameters = cv::aruco::DetectorParameters::create();
  std::vector<std::vector<Point2f>> markers;
  std::vector<int> marker_ids;
  cv::aruco::detectMarkers(eight, charuco->dictionary, markers, marker_ids, parameters);
  if (marker_ids.empty()) return {};
  std::vector<Point2f> points;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(markers, marker_ids, eight, charuco, points, ids);
  if (points.empty()) return {};
  if (settings.is_refined) {
    const int window =
        std::clamp(static_cast<int>(square_px(markers, board) / 5.0), settings.window_low_px, settings.window_high_px);
    const float border = static_cast<float>(window) + 2.0F;
    std::vector<Point2f> inside;
    std::vector<int> inside_ids;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Point2f& p = points[k];
      if (!(p.x > border && p.y > border && p.x < static_cast<float>(image.width) - border &&
            p.y < static_cast<float>(image.height) - border))
        continue;
      inside.push_back(p);
      inside_ids.push_back(ids[k]);
    }
    points = std::move(inside);
    ids = std::move(inside_ids);
    if (points.empty()) return {};
    // The light itself, not rounded to 256 steps.
    cv::cornerSubPix(stretched(image, CV_32FC1), points, cv::Size(window, window), cv::Size(-1, -1),
                     cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-4));
  }
  std::vector<Corner> corners;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (ids[k] >= 0 && ids[k] < board.corner_count())
      corners.push_back({ids[k], fsw::Vector2(points[k].x, points[k].y)});
  std::ranges::sort(corners, {}, &Corner::id);
  return on_a_plane(corners, board, settings.outlier_px);
}

}  // namespace vbar::tron::calibrate
