#include "hil_drivers/optical_stimulator/hardware/display.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include <SDL.h>
#include <SDL_syswm.h>
#include <fmt/format.h>

#include "hil_drivers/optical_stimulator/hardware/x_screen.h"

namespace vbar::optical_stimulator {
namespace {

[[noreturn]] void fail_by_sdl(const char* what) {
  throw std::runtime_error(fmt::format("{}: {}", what, SDL_GetError()));
}

/// SDL takes the name of the X display from the environment only, while it starts; child processes keep that of this
/// program.
class EnvironmentDisplay {
 public:
  explicit EnvironmentDisplay(const std::string& name) {
    if (name.empty()) return;
    const char* const before = std::getenv("DISPLAY");
    before_ = before != nullptr ? before : "";
    had_one_ = before != nullptr;
    is_set_ = true;
    ::setenv("DISPLAY", name.c_str(), 1);
  }
  ~EnvironmentDisplay() {
    if (!is_set_) return;
    if (had_one_)
      ::setenv("DISPLAY", before_.c_str(), 1);
    else
      ::unsetenv("DISPLAY");
  }
  EnvironmentDisplay(const EnvironmentDisplay&) = delete;
  EnvironmentDisplay& operator=(const EnvironmentDisplay&) = delete;

 private:
  std::string before_;
  bool had_one_ = false, is_set_ = false;
};

int output_named(const std::string& name) {
  const int count = SDL_GetNumVideoDisplays();
  if (count < 1) fail_by_sdl("there is no output");
  if (name.empty()) {
    if (count > 1) throw std::runtime_error(fmt::format("there are {} outputs, and the setting names none", count));
    return 0;
  }
  std::string names;
  for (int k = 0; k < count; ++k) {
    const char* const one = SDL_GetDisplayName(k);
    if (one != nullptr && name == one) return k;
    names += (names.empty() ? "" : ", ") + std::string(one != nullptr ? one : "?");
  }
  throw std::runtime_error(fmt::format("there is no output \"{}\", only {}", name, names));
}

}  // namespace

namespace {

/// SDL keeps a connection whose server is gone, and cannot be closed without it.
bool has_lost_connection = false;

}  // namespace

struct Display::Window {
  explicit Window(const DisplaySettings& settings) {
    if (has_lost_connection)
      throw std::runtime_error("this program has lost an X server before, and cannot open another one");
    const EnvironmentDisplay environment(settings.x_display);
    SDL_SetMainReady();
    SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11");
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    // The surface goes to the server as it is, without a renderer that could scale or convert it.
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "0");
    SDL_SetHint(SDL_HINT_VIDEO_MINIMIZE_ON_FOCUS_LOSS, "0");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) fail_by_sdl("cannot be opened");
    try {
      open(settings);
    } catch (...) {
      close();
      throw;
    }
  }
  ~Window() { close(); }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  void open(const DisplaySettings& settings) {
    const int output = output_named(settings.output);
    SDL_Rect bounds;
    if (SDL_GetDisplayBounds(output, &bounds) != 0) fail_by_sdl("its size is unknown");
    const bool is_calibrated = settings.width > 0;
    if (is_calibrated && (bounds.w != settings.width || bounds.h != settings.height))
      throw std::runtime_error(fmt::format("it is of {} x {} pixels, and the calibration is for one of {} x {}",
                                           bounds.w, bounds.h, settings.width, settings.height));
    left = bounds.x;
    top = bounds.y;
    width = bounds.w;
    height = bounds.h;
    window = SDL_CreateWindow("vbar", left, top, bounds.w, bounds.h,
                              SDL_WINDOW_BORDERLESS | SDL_WINDOW_ALWAYS_ON_TOP | SDL_WINDOW_FULLSCREEN_DESKTOP);
    if (window == nullptr) fail_by_sdl("no window can be opened");
    SDL_ShowCursor(SDL_DISABLE);
    SDL_SysWMinfo info;
    SDL_VERSION(&info.version);
    if (SDL_GetWindowWMInfo(window, &info) != SDL_TRUE || info.subsystem != SDL_SYSWM_X11)
      throw std::runtime_error("it is not of an X server");
    connection = info.info.x11.display;
    survive_loss(connection, is_lost);
    surface();
  }

  void close() {
    // SDL would wait for answers of a server that is gone.
    if (is_lost) {
      has_lost_connection = true;
      return;
    }
    if (window != nullptr) SDL_DestroyWindow(window);
    window = nullptr;
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }

  /// Returns the surface of the window now: it is another one after a change of mode.
  SDL_Surface* surface() {
    SDL_PumpEvents();
    SDL_Surface* const now = SDL_GetWindowSurface(window);
    if (now == nullptr) fail_by_sdl("the window has no pixels");
    if (now->format->BytesPerPixel != 4) throw std::runtime_error("it has no pixels of 32 bits");
    return now;
  }

  SDL_Window* window = nullptr;
  _XDisplay* connection = nullptr;
  int left = 0, top = 0, width = 0, height = 0;
  bool is_lost = false;
  bool is_silent = false;  ///< lost because the server did not answer
};

Display::Display(const DisplaySettings& settings) : settings_(settings) {
  try {
    window_ = std::make_unique<Window>(settings);
    settings_.width = window_->width;
    settings_.height = window_->height;
    if (const std::string complaint = gamma_complaint(window_->connection); !complaint.empty())
      throw std::runtime_error(complaint);
    check_pixels();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("display {}{}{}: {}",
                                         settings.x_display.empty() ? "of the environment" : settings.x_display,
                                         settings.output.empty() ? "" : " ", settings.output, error.what()));
  }
}

Display::~Display() {
  try {
    show(Picture(settings_.width, settings_.height));
  } catch (...) {
    // The screen is lost: nothing is left to be shown.
  }
}

/// Every count, at places that a mirrored, shifted or scaled picture would not have it; then black.
void Display::check_pixels() {
  Picture picture(settings_.width, settings_.height);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) picture.at(x, y) = static_cast<std::uint8_t>((x + 7 * y) % 256);
  // A window appears some time after it has been asked for, at the latest when the server has had a second for it.
  constexpr int kTries = 50, kBetween_ms = 20;
  for (int k = 0; k < kTries; ++k) {
    show(picture);
    Picture back;
    try {
      back = read_back();
    } catch (const std::runtime_error&) {
      if (k + 1 == kTries) throw;
    }
    if (back.counts == picture.counts) {
      show(Picture(settings_.width, settings_.height));
      return;
    }
    SDL_Delay(kBetween_ms);
  }
  throw std::runtime_error("the pixels read back are not those sent: it is covered, scaled or changes colours");
}

void Display::show(const Picture& picture) {
  if (picture.width != settings_.width || picture.height != settings_.height)
    throw std::runtime_error("a picture is not of the display's size");
  check_connection();
  int status = 0;
  {
    const AnswerLimit limit(window_->connection, settings_.answer_limit, window_->is_silent);
    status = draw(picture);
    if (!window_->is_lost) wait_for_server(window_->connection);
  }
  check_connection();
  if (status != 0) fail_by_sdl("the window cannot be drawn");
}

void Display::check_connection() const {
  if (!window_->is_lost) return;
  if (window_->is_silent)
    throw std::runtime_error(fmt::format("display {}: its X server has not answered for {:g} s", settings_.x_display,
                                         std::chrono::duration<double>(settings_.answer_limit).count()));
  throw std::runtime_error(fmt::format("display {}: its X server has closed the connection", settings_.x_display));
}

/// The status of SDL.
int Display::draw(const Picture& picture) {
  SDL_Surface* const surface = window_->surface();
  if (surface->w != picture.width || surface->h != picture.height)
    throw std::runtime_error(
        fmt::format("the window is of {} x {} pixels, not of the display's size", surface->w, surface->h));
  std::array<std::uint32_t, 256> greys;
  for (std::size_t count = 0; count < greys.size(); ++count) {
    const auto channel = static_cast<std::uint8_t>(count);
    greys[count] = SDL_MapRGB(surface->format, channel, channel, channel);
  }
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* const from = picture.counts.data() + picture.place(0, y);
    auto* const row = static_cast<std::uint8_t*>(surface->pixels) + static_cast<std::ptrdiff_t>(y) * surface->pitch;
    auto* const to = static_cast<std::uint32_t*>(static_cast<void*>(row));
    for (int x = 0; x < picture.width; ++x) to[x] = greys[from[x]];
  }
  return SDL_UpdateWindowSurface(window_->window);
}

Picture Display::read_back() const {
  check_connection();
  const AnswerLimit limit(window_->connection, settings_.answer_limit, window_->is_silent);
  return read_screen(window_->connection, window_->left, window_->top, settings_.width, settings_.height);
}

}  // namespace vbar::optical_stimulator
