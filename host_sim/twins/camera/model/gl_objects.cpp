#include "host_sim/twins/camera/model/gl_objects.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>

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

namespace {

OSMesaContext created_context() {
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
  OSMesaContext const context = gl().OSMesaCreateContextAttribs(kAttributes.data(), nullptr);
  if (context == nullptr) throw std::runtime_error("OSMesa gives no OpenGL 3.3 core context");
  return context;
}

}  // namespace

void GlContext::prepare() {
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
    // Mesa ends at exit what its first context began. It begins here, so that a static object made after this call is
    // destroyed before Mesa ends. 20 ms.
    gl().OSMesaDestroyContext(created_context());
  });
}

GlContext::GlContext() {
  prepare();
  handle_ = created_context();
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

namespace {

class Shader {
 public:
  Shader(GLenum stage, std::string_view source) : id_(gl().glCreateShader(stage)) {
    const char* const text = source.data();
    const auto length = static_cast<GLint>(source.size());
    gl().glShaderSource(id_, 1, &text, &length);
    gl().glCompileShader(id_);
    GLint good = GL_FALSE;
    gl().glGetShaderiv(id_, GL_COMPILE_STATUS, &good);
    if (good == GL_TRUE) return;
    std::array<char, 2048> log{};
    gl().glGetShaderInfoLog(id_, log.size(), nullptr, log.data());
    gl().glDeleteShader(id_);
    throw std::runtime_error(std::string("a shader does not compile: ") + log.data());
  }
  ~Shader() { gl().glDeleteShader(id_); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  [[nodiscard]] GLuint id() const { return id_; }

 private:
  GLuint id_;
};

void check_framebuffer(const char* what) {
  if (gl().glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error(std::string("OpenGL refuses the framebuffer of ") + what);
}

}  // namespace

GlProgram::GlProgram(std::string_view vertex_source, std::string_view fragment_source) {
  const Shader vertex(GL_VERTEX_SHADER, vertex_source), fragment(GL_FRAGMENT_SHADER, fragment_source);
  id_ = gl().glCreateProgram();
  gl().glAttachShader(id_, vertex.id());
  gl().glAttachShader(id_, fragment.id());
  gl().glLinkProgram(id_);
  GLint good = GL_FALSE;
  gl().glGetProgramiv(id_, GL_LINK_STATUS, &good);
  if (good == GL_TRUE) return;
  std::array<char, 2048> log{};
  gl().glGetProgramInfoLog(id_, log.size(), nullptr, log.data());
  gl().glDeleteProgram(id_);
  throw std::runtime_error(std::string("shaders do not link: ") + log.data());
}

GlProgram::~GlProgram() {
  gl().glDeleteProgram(id_);
}

void GlProgram::use() const {
  gl().glUseProgram(id_);
}

GLint GlProgram::uniform(const char* name) const {
  const GLint place = gl().glGetUniformLocation(id_, name);
  if (place < 0) throw std::runtime_error(std::string("no uniform ") + name);
  return place;
}

GlTriangles::GlTriangles(std::span<const float> interleaved, std::span<const int> widths) {
  int stride = 0;
  for (const int width : widths) stride += width;
  vertices_ = static_cast<GLsizei>(interleaved.size() / static_cast<std::size_t>(stride));
  gl().glGenVertexArrays(1, &array_);
  gl().glBindVertexArray(array_);
  gl().glGenBuffers(1, &buffer_);
  gl().glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  gl().glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(interleaved.size_bytes()), interleaved.data(),
                    GL_STATIC_DRAW);
  constexpr int kFloat = sizeof(float);
  std::uintptr_t offset = 0;  // OpenGL takes it in the form of a pointer
  for (GLuint location = 0; location < widths.size(); ++location) {
    gl().glEnableVertexAttribArray(location);
    gl().glVertexAttribPointer(location, widths[location], GL_FLOAT, GL_FALSE, stride * kFloat,
                               reinterpret_cast<const void*>(offset));
    offset += static_cast<std::uintptr_t>(widths[location] * kFloat);
  }
}

GlTriangles::~GlTriangles() {
  gl().glDeleteBuffers(1, &buffer_);
  gl().glDeleteVertexArrays(1, &array_);
}

void GlTriangles::draw() const {
  gl().glBindVertexArray(array_);
  gl().glDrawArrays(GL_TRIANGLES, 0, vertices_);
}

GlShadowMap::GlShadowMap(int size) : size_(size) {
  gl().glGenTextures(1, &texture_);
  gl().glBindTexture(GL_TEXTURE_2D, texture_);
  gl().glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size, size, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  gl().glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl().glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl().glGenFramebuffers(1, &framebuffer_);
  gl().glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl().glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  gl().glDrawBuffer(GL_NONE);
  gl().glReadBuffer(GL_NONE);
  check_framebuffer("a shadow map");
}

GlShadowMap::~GlShadowMap() {
  gl().glDeleteFramebuffers(1, &framebuffer_);
  gl().glDeleteTextures(1, &texture_);
}

void GlShadowMap::bind_and_clear() const {
  gl().glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl().glViewport(0, 0, size_, size_);
  gl().glClear(GL_DEPTH_BUFFER_BIT);
}

void GlShadowMap::bind_texture() const {
  gl().glActiveTexture(GL_TEXTURE0);
  gl().glBindTexture(GL_TEXTURE_2D, texture_);
}

GlTable::GlTable() {
  gl().glGenTextures(1, &texture_);
  bind_texture();
  gl().glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl().glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl().glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
}

GlTable::~GlTable() {
  gl().glDeleteTextures(1, &texture_);
}

void GlTable::set(std::span<const float> numbers) {
  bind_texture();
  gl().glTexImage1D(GL_TEXTURE_1D, 0, GL_R32F, static_cast<GLsizei>(numbers.size()), 0, GL_RED, GL_FLOAT,
                    numbers.data());
}

void GlTable::bind_texture() const {
  gl().glActiveTexture(GL_TEXTURE1);
  gl().glBindTexture(GL_TEXTURE_1D, texture_);
}

GlPicture::GlPicture(int size, int samples) : size_(size) {
  const auto renderbuffer = [size](GLuint& id, int of_a_texel, GLenum format) {
    gl().glGenRenderbuffers(1, &id);
    gl().glBindRenderbuffer(GL_RENDERBUFFER, id);
    gl().glRenderbufferStorageMultisample(GL_RENDERBUFFER, of_a_texel, format, size, size);
  };
  const int multisamples = samples > 1 ? samples : 0;
  renderbuffer(colour_, multisamples, GL_R32F);
  renderbuffer(depth_, multisamples, GL_DEPTH_COMPONENT32F);
  renderbuffer(mean_, 0, GL_R32F);
  gl().glGenFramebuffers(1, &drawn_);
  gl().glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
  gl().glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
  gl().glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  check_framebuffer("a picture");
  gl().glGenFramebuffers(1, &resolved_);
  gl().glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
  gl().glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, mean_);
  check_framebuffer("one float a texel");
}

GlPicture::~GlPicture() {
  gl().glDeleteFramebuffers(1, &drawn_);
  gl().glDeleteFramebuffers(1, &resolved_);
  gl().glDeleteRenderbuffers(1, &colour_);
  gl().glDeleteRenderbuffers(1, &depth_);
  gl().glDeleteRenderbuffers(1, &mean_);
}

void GlPicture::bind_and_clear() const {
  gl().glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
  gl().glViewport(0, 0, size_, size_);
  gl().glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void GlPicture::read(std::vector<float>& texels) const {
  gl().glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
  gl().glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  gl().glBlitFramebuffer(0, 0, size_, size_, 0, 0, size_, size_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl().glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  texels.resize(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_));
  gl().glPixelStorei(GL_PACK_ALIGNMENT, 1);
  gl().glReadPixels(0, 0, size_, size_, GL_RED, GL_FLOAT, texels.data());
}

}  // namespace vbar::twins::camera
