#pragma once
// OpenGL without a display: Mesa's off-screen library, which draws on the processor.

#include <array>

namespace vbar::twins::camera {

/// One OpenGL 3.3 core context. It belongs to no thread: the caller makes it current while rendering.
class GlContext {
 public:
  /// Throws std::runtime_error if there is no such context. The first one keeps Mesa from writing a shader cache into
  /// the home folder, unless MESA_SHADER_CACHE_DISABLE is set to something else: it sets that environment variable, so
  /// create the first one before other threads start.
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Scope during whose lifetime the context is current in the calling thread, afterwards in none.
  class Current {
   public:
    explicit Current(GlContext& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
  };

 private:
  void* handle_ = nullptr;
  std::array<unsigned char, 4> surface_{};  // OSMesa asks for one; everything is drawn into framebuffer objects
};

}  // namespace vbar::twins::camera
