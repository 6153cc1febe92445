#pragma once
// A test double of an optical testbed: the digital image, with a pattern of pixels raised by a number that no image has
// had before.

#include <algorithm>
#include <atomic>
#include <memory>
#include <utility>

#include "host_sim/twins/camera/image_maker.h"

namespace vbar::test {

class UnreproducibleTaker final : public twins::camera::ImageTaker {
 public:
  explicit UnreproducibleTaker(std::unique_ptr<twins::camera::ImageMaker> digital) : digital_(std::move(digital)) {}

  twins::camera::TakenImage take(const twins::camera::Exposure& exposure) override {
    static std::atomic<std::uint32_t> images{0};
    const std::uint32_t number = ++images;
    twins::camera::TakenImage image = digital_->take(exposure);
    const auto white = static_cast<std::uint32_t>((1 << digital_->settings().camera.detector.bits) - 1);
    // The bits of the number, small enough that the stars are still found.
    for (std::size_t k = 0; k < image.dn.size(); ++k)
      if ((number >> (k % 16U) & 1U) != 0)
        image.dn[k] = static_cast<std::uint16_t>(std::min<std::uint32_t>(image.dn[k] + 3U, white));
    image.notes.push_back({"test_image", static_cast<double>(number)});
    return image;
  }
  [[nodiscard]] std::vector<twins::Note> statistics() const override { return digital_->statistics(); }

 private:
  std::unique_ptr<twins::camera::ImageMaker> digital_;
};

}  // namespace vbar::test
