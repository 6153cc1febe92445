#pragma once
// OpenGL without a display: Mesa's off-screen library, which draws on the processor.

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "host_sim/twins/camera/model/gl_functions.h"

namespace vbar::twins::camera {

/// One OpenGL 3.3 core context. It belongs to no thread: the caller makes it current while rendering.
class GlContext {
 public:
  /// Loads Mesa, and keeps it from writing a shader cache into the home folder, unless MESA_SHADER_CACHE_DISABLE is set
  /// to something else: it sets that environment variable, so call it before other threads start. Throws
  /// std::runtime_error if the library is missing.
  static void prepare();

  /// Prepares, and makes a context. Throws std::runtime_error if there is no such context.
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

// Owners of the OpenGL objects of the target renderer. All need their context to be current in their
// constructors, destructors and calls.

using namespace opengl;

/// A linked vertex and fragment shader. Throws std::runtime_error with the message of the compiler.
class GlProgram {
 public:
  GlProgram(std::string_view vertex_source, std::string_view fragment_source);
  ~GlProgram();
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void use() const;
  [[nodiscard]] GLint uniform(const char* name) const;  ///< place of a uniform; throws if the program has none

 private:
  GLuint id_ = 0;
};

/// Triangles on the drawing side: interleaved attributes of `widths` floats each, at locations 0, 1, ...
class GlTriangles {
 public:
  GlTriangles(std::span<const float> interleaved, std::span<const int> widths);
  ~GlTriangles();
  GlTriangles(const GlTriangles&) = delete;
  GlTriangles& operator=(const GlTriangles&) = delete;

  void draw() const;

 private:
  GLuint array_ = 0, buffer_ = 0;
  GLsizei vertices_ = 0;
};

/// A square of depths that a shader can read: the range of parallel light.
class GlShadowMap {
 public:
  explicit GlShadowMap(int size);
  ~GlShadowMap();
  GlShadowMap(const GlShadowMap&) = delete;
  GlShadowMap& operator=(const GlShadowMap&) = delete;

  void bind_and_clear() const;  ///< to draw into
  void bind_texture() const;    ///< to texture unit 0
  [[nodiscard]] int size() const { return size_; }

 private:
  GLuint framebuffer_ = 0, texture_ = 0;
  int size_ = 0;
};

/// A row of numbers that a shader interpolates.
class GlTable {
 public:
  GlTable();
  ~GlTable();
  GlTable(const GlTable&) = delete;
  GlTable& operator=(const GlTable&) = delete;

  void set(std::span<const float> numbers);
  void bind_texture() const;  ///< to texture unit 1

 private:
  GLuint texture_ = 0;
};

/// A square picture of one float a texel, drawn with four samples a texel or (`samples` 1) one.
class GlPicture {
 public:
  GlPicture(int size, int samples);
  ~GlPicture();
  GlPicture(const GlPicture&) = delete;
  GlPicture& operator=(const GlPicture&) = delete;

  void bind_and_clear() const;
  void read(std::vector<float>& texels) const;  ///< means of the samples, rows from the lowest clip-space y
  [[nodiscard]] int size() const { return size_; }

 private:
  GLuint drawn_ = 0, resolved_ = 0;           // framebuffers
  GLuint colour_ = 0, depth_ = 0, mean_ = 0;  // renderbuffers
  int size_ = 0;
};

}  // namespace vbar::twins::camera
