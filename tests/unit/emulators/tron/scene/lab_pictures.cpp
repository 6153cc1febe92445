// Draws views of the laboratory beside the digital twin's image, for people to look at: lab_pictures FOLDER.

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <png.h>

#include "emulators/tron/scene/lab_renderer.h"
#include "hil_drivers/tron/geometry/board_design.h"
#include "tests/unit/emulators/tron/scene/lab_scenes.h"

namespace vbar::tron::bench::tests {
namespace {

constexpr double kWhite = 20000.0;

// Pictures side by side, the square root of the light.
void write(const std::vector<const camera::PhotonImage*>& images, const std::filesystem::path& file) {
  const int width = images[0]->region.width, height = images[0]->region.height;
  std::vector<png_byte> grey(images.size() * static_cast<std::size_t>(width * height));
  for (std::size_t number = 0; number < images.size(); ++number)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double light = static_cast<double>(images[number]->electrons[static_cast<std::size_t>(y * width + x)]);
        grey[(static_cast<std::size_t>(y) * images.size() + number) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(x)] =
            static_cast<png_byte>(255.0 * std::sqrt(std::clamp(light / kWhite, 0.0, 1.0)));
      }
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(images.size() * static_cast<std::size_t>(width));
  header.height = static_cast<png_uint_32>(height);
  header.format = PNG_FORMAT_GRAY;
  png_image_write_to_file(&header, file.c_str(), 0, grey.data(), 0, nullptr);
}

void draw(const std::filesystem::path& folder) {
  const TestbedDesign bench = tron_bench();
  const std::filesystem::path data = vbar::tests::source_path("data");
  LabRenderer with(bench, {}, 1, data), without(bench, GapSettings::none(), 1, data);
  const camera::CadModel model = camera::load_cad_model(data / "models/tango.obj");
  camera::TargetRenderer renderer(model);
  for (const double distance : {2.5, 4.0}) {
    LabView view = view_of(distance, some_attitude());
    view.arms = {{{6.7, -0.3, 1.0}, {7.0, 0.0, 0.5}, 0.08}};
    const camera::PhotonImage all_on = with.expected(view);
    constexpr int kTimes = 5;
    const std::clock_t start = std::clock();
    for (int k = 0; k < kTimes; ++k) static_cast<void>(with.expected(view));
    const std::clock_t drawn = std::clock();
    for (int k = 0; k < kTimes; ++k) static_cast<void>(with.expose(view));
    const double per_ms = 1e3 / (kTimes * static_cast<double>(CLOCKS_PER_SEC));
    const double light_ms = per_ms * static_cast<double>(drawn - start);
    const double all_ms = per_ms * static_cast<double>(std::clock() - drawn);
    const camera::PhotonImage all_off = without.expected(view);
    const camera::PhotonImage twin = twin_image(renderer, bench, view, model.centre);
    write({&all_on, &all_off, &twin}, folder / fmt::format("mockup_{:.1f}m.png", distance));
    fmt::print("mock-up at {} m: {:.0f} ms of a processor for the light, {:.0f} ms with the sensor\n", distance,
               light_ms, all_ms);
  }
  LabView view = view_of(3.5);
  view.T_L_board = view.T_L_T;
  view.T_L_board->linear() =
      view.T_L_C.linear() * Eigen::AngleAxisd(-0.5, Vector3(0.2, 1.0, 0.3).normalized()).toRotationMatrix();
  view.camera.exposure_s *= 0.5;
  write({&with.expected(view)}, folder / "board_3.5m.png");
}

}  // namespace
}  // namespace vbar::tron::bench::tests

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: lab_pictures FOLDER\n");
    return 2;
  }
  vbar::tron::bench::tests::draw(argv[1]);
}
