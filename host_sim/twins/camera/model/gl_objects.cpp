#include "host_sim/twins/camera/model/gl_objects.h"

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace vbar::twins::camera {
namespace {

class Shader {
 public:
  Shader(GLenum stage, std::string_view source) : id_(glCreateShader(stage)) {
    const char* const text = source.data();
    const auto length = static_cast<GLint>(source.size());
    glShaderSource(id_, 1, &text, &length);
    glCompileShader(id_);
    GLint good = GL_FALSE;
    glGetShaderiv(id_, GL_COMPILE_STATUS, &good);
    if (good == GL_TRUE) return;
    std::array<char, 2048> log{};
    glGetShaderInfoLog(id_, log.size(), nullptr, log.data());
    glDeleteShader(id_);
    throw std::runtime_error(std::string("a shader does not compile: ") + log.data());
  }
  ~Shader() { glDeleteShader(id_); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  [[nodiscard]] GLuint id() const { return id_; }

 private:
  GLuint id_;
};

void check_framebuffer(const char* what) {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error(std::string("OpenGL refuses the framebuffer of ") + what);
}

}  // namespace

GlProgram::GlProgram(std::string_view vertex_source, std::string_view fragment_source) {
  const Shader vertex(GL_VERTEX_SHADER, vertex_source), fragment(GL_FRAGMENT_SHADER, fragment_source);
  id_ = glCreateProgram();
  glAttachShader(id_, vertex.id());
  glAttachShader(id_, fragment.id());
  glLinkProgram(id_);
  GLint good = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &good);
  if (good == GL_TRUE) return;
  std::array<char, 2048> log{};
  glGetProgramInfoLog(id_, log.size(), nullptr, log.data());
  glDeleteProgram(id_);
  throw std::runtime_error(std::string("shaders do not link: ") + log.data());
}

GlProgram::~GlProgram() {
  glDeleteProgram(id_);
}

void GlProgram::use() const {
  glUseProgram(id_);
}

GLint GlProgram::uniform(const char* name) const {
  const GLint place = glGetUniformLocation(id_, name);
  if (place < 0) throw std::runtime_error(std::string("no uniform ") + name);
  return place;
}

GlTriangles::GlTriangles(std::span<const float> interleaved, std::span<const int> widths) {
  int stride = 0;
  for (const int width : widths) stride += width;
  vertices_ = static_cast<GLsizei>(interleaved.size() / static_cast<std::size_t>(stride));
  glGenVertexArrays(1, &array_);
  glBindVertexArray(array_);
  glGenBuffers(1, &buffer_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(interleaved.size_bytes()), interleaved.data(), GL_STATIC_DRAW);
  constexpr int kFloat = sizeof(float);
  std::uintptr_t offset = 0;  // OpenGL takes it in the form of a pointer
  for (GLuint location = 0; location < widths.size(); ++location) {
    glEnableVertexAttribArray(location);
    glVertexAttribPointer(location, widths[location], GL_FLOAT, GL_FALSE, stride * kFloat,
                          reinterpret_cast<const void*>(offset));
    offset += static_cast<std::uintptr_t>(widths[location] * kFloat);
  }
}

GlTriangles::~GlTriangles() {
  glDeleteBuffers(1, &buffer_);
  glDeleteVertexArrays(1, &array_);
}

void GlTriangles::draw() const {
  glBindVertexArray(array_);
  glDrawArrays(GL_TRIANGLES, 0, vertices_);
}

GlShadowMap::GlShadowMap(int size) : size_(size) {
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size, size, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  check_framebuffer("a shadow map");
}

GlShadowMap::~GlShadowMap() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
}

void GlShadowMap::bind_and_clear() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, size_, size_);
  glClear(GL_DEPTH_BUFFER_BIT);
}

void GlShadowMap::bind_texture() const {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_);
}

GlTable::GlTable() {
  glGenTextures(1, &texture_);
  bind_texture();
  glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_1D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
}

GlTable::~GlTable() {
  glDeleteTextures(1, &texture_);
}

void GlTable::set(std::span<const float> numbers) {
  bind_texture();
  glTexImage1D(GL_TEXTURE_1D, 0, GL_R32F, static_cast<GLsizei>(numbers.size()), 0, GL_RED, GL_FLOAT, numbers.data());
}

void GlTable::bind_texture() const {
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_1D, texture_);
}

GlPicture::GlPicture(int size, int samples) : size_(size) {
  const auto renderbuffer = [size](GLuint& id, int of_a_texel, GLenum format) {
    glGenRenderbuffers(1, &id);
    glBindRenderbuffer(GL_RENDERBUFFER, id);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, of_a_texel, format, size, size);
  };
  const int multisamples = samples > 1 ? samples : 0;
  renderbuffer(colour_, multisamples, GL_R32F);
  renderbuffer(depth_, multisamples, GL_DEPTH_COMPONENT32F);
  renderbuffer(mean_, 0, GL_R32F);
  glGenFramebuffers(1, &drawn_);
  glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  check_framebuffer("a picture");
  glGenFramebuffers(1, &resolved_);
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, mean_);
  check_framebuffer("one float a texel");
}

GlPicture::~GlPicture() {
  glDeleteFramebuffers(1, &drawn_);
  glDeleteFramebuffers(1, &resolved_);
  glDeleteRenderbuffers(1, &colour_);
  glDeleteRenderbuffers(1, &depth_);
  glDeleteRenderbuffers(1, &mean_);
}

void GlPicture::bind_and_clear() const {
  glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
  glViewport(0, 0, size_, size_);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void GlPicture::read(std::vector<float>& texels) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  glBlitFramebuffer(0, 0, size_, size_, 0, 0, size_, size_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  texels.resize(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size_, size_, GL_RED, GL_FLOAT, texels.data());
}

}  // namespace vbar::twins::camera
