#include "host_sim/twins/camera/model/gl_context.h"

#include <cstdlib>
#include <mutex>
#include <stdexcept>

#include "host_sim/twins/camera/model/gl_functions.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define VBAR_LEAKS_ARE_LOOKED_FOR
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define VBAR_LEAKS_ARE_LOOKED_FOR
#endif

#ifdef VBAR_LEAKS_ARE_LOOKED_FOR
// OSMesa 22.3 never frees the record of a context's surface, 160 bytes a context.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOSMesa.so\n";
}
#endif

namespace vbar::twins::camera {

using namespace opengl;

GlContext::GlContext() {
  static std::once_flag once;
  std::call_once(once, [] { setenv("MESA_SHADER_CACHE_DISABLE", "true", 0); });
  constexpr std::array<int, 15> kAttributes{OSMESA_FORMAT,
                                            OSMESA_RGBA,
                                            OSMESA_DEPTH_BITS,
                                            0,
                                            OSMESA_STENCIL_BITS,
                                            0,
                                            OSMESA_ACCUM_BITS,
                                            0,
                                            OSMESA_PROFILE,
                                            OSMESA_CORE_PROFILE,
                                            OSMESA_CONTEXT_MAJOR_VERSION,
                                            3,
                                            OSMESA_CONTEXT_MINOR_VERSION,
                                            3,
                                            0};
  handle_ = gl().OSMesaCreateContextAttribs(kAttributes.data(), nullptr);
  if (handle_ == nullptr) throw std::runtime_error("OSMesa gives no OpenGL 3.3 core context");
}

GlContext::~GlContext() {
  gl().OSMesaDestroyContext(static_cast<OSMesaContext>(handle_));
}

GlContext::Current::Current(GlContext& context) {
  if (gl().OSMesaMakeCurrent(static_cast<OSMesaContext>(context.handle_), context.surface_.data(), GL_UNSIGNED_BYTE, 1,
                             1) != GL_TRUE)
    throw std::runtime_error("OSMesa cannot make its context current");
}

GlContext::Current::~Current() {
  gl().OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
}

}  // namespace vbar::twins::camera
