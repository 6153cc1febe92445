#pragma once
// Targets of the drawing. All need their context to be current, as those of gl_objects.h.

#include <vector>

#include "host_sim/twins/camera/model/gl_objects.h"

namespace vbar::tron::bench {

using namespace opengl;

/// Holds a square of one float a texel with four samples a texel, of which a corner is used.
class Canvas {
 public:
  explicit Canvas(int size);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void bind_and_clear(int width, int height) const;
  /// Reads means of the samples, rows from the lowest clip-space y.
  void read(int width, int height, std::vector<float>& texels) const;
  [[nodiscard]] int size() const { return size_; }

 private:
  GLuint drawn_ = 0, resolved_ = 0;           // framebuffers
  GLuint colour_ = 0, depth_ = 0, mean_ = 0;  // renderbuffers
  int size_;
};

/// Holds eight maps of depths in a texture, 4 x 2 of them.
class ShadowMaps {
 public:
  static constexpr int kCount = 8, kAcross = 4, kDown = 2;
  explicit ShadowMaps(int size);
  ~ShadowMaps();
  ShadowMaps(const ShadowMaps&) = delete;
  ShadowMaps& operator=(const ShadowMaps&) = delete;

  void bind_and_clear() const;
  void draw_into(int number) const;
  void bind_texture() const;  ///< to texture unit 0
  [[nodiscard]] int size() const { return size_; }

 private:
  GLuint framebuffer_ = 0, texture_ = 0;
  int size_;
};

}  // namespace vbar::tron::bench
