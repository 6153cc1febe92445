#include "emulators/tron/scene/gl_targets.h"

#include <stdexcept>
#include <string>

namespace vbar::tron::bench {
namespace {

void check_framebuffer(const char* what) {
  if (gl().glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error(std::string("OpenGL refuses the framebuffer of ") + what);
}

}  // namespace

Canvas::Canvas(int size) : size_(size) {
  const auto renderbuffer = [size](GLuint& id, int samples, GLenum format) {
    gl().glGenRenderbuffers(1, &id);
    gl().glBindRenderbuffer(GL_RENDERBUFFER, id);
    gl().glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, size, size);
  };
  renderbuffer(colour_, 4, GL_R32F);
  renderbuffer(depth_, 4, GL_DEPTH_COMPONENT32F);
  renderbuffer(mean_, 0, GL_R32F);
  gl().glGenFramebuffers(1, &drawn_);
  gl().glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
  gl().glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
  gl().glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  check_framebuffer("a canvas");
  gl().glGenFramebuffers(1, &resolved_);
  gl().glBindFramebuffer(GL_FRAMEBUFFER, resolved_);
  gl().glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, mean_);
  check_framebuffer("one float a texel");
}

Canvas::~Canvas() {
  gl().glDeleteFramebuffers(1, &drawn_);
  gl().glDeleteFramebuffers(1, &resolved_);
  gl().glDeleteRenderbuffers(1, &colour_);
  gl().glDeleteRenderbuffers(1, &depth_);
  gl().glDeleteRenderbuffers(1, &mean_);
}

void Canvas::bind_and_clear(int width, int height) const {
  gl().glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
  gl().glViewport(0, 0, width, height);
  gl().glEnable(GL_SCISSOR_TEST);
  gl().glScissor(0, 0, width, height);
  gl().glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void Canvas::read(int width, int height, std::vector<float>& texels) const {
  gl().glDisable(GL_SCISSOR_TEST);
  gl().glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
  gl().glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  gl().glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl().glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  texels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  gl().glPixelStorei(GL_PACK_ALIGNMENT, 1);
  gl().glReadPixels(0, 0, width, height, GL_RED, GL_FLOAT, texels.data());
}

ShadowMaps::ShadowMaps(int size) : size_(size) {
  gl().glGenTextures(1, &texture_);
  gl().glActiveTexture(GL_TEXTURE0);
  gl().glBindTexture(GL_TEXTURE_2D, texture_);
  gl().glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, kAcross * size, kDown * size, 0, GL_DEPTH_COMPONENT,
                    GL_FLOAT, nullptr);
  gl().glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl().glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl().glGenFramebuffers(1, &framebuffer_);
  gl().glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl().glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  gl().glDrawBuffer(GL_NONE);
  gl().glReadBuffer(GL_NONE);
  check_framebuffer("the shadow maps");
}

ShadowMaps::~ShadowMaps() {
  gl().glDeleteFramebuffers(1, &framebuffer_);
  gl().glDeleteTextures(1, &texture_);
}

void ShadowMaps::bind_and_clear() const {
  gl().glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl().glDisable(GL_SCISSOR_TEST);
  gl().glClear(GL_DEPTH_BUFFER_BIT);
}

void ShadowMaps::draw_into(int number) const {
  const int x = number % kAcross * size_, y = number / kAcross * size_;
  gl().glViewport(x, y, size_, size_);
  gl().glEnable(GL_SCISSOR_TEST);  // clamped depths keep triangles that reach over the map
  gl().glScissor(x, y, size_, size_);
}

void ShadowMaps::bind_texture() const {
  gl().glActiveTexture(GL_TEXTURE0);
  gl().glBindTexture(GL_TEXTURE_2D, texture_);
}

}  // namespace vbar::tron::bench
