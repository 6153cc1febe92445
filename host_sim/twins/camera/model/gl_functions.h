#pragma once
// The part of OpenGL that is used here, and Mesa's off-screen library, which is loaded when the first of its functions
// is called: it brings a compiler with it, and most runs draw nothing. gl().glClear(...) is OpenGL's glClear(...).
// Names, values and types are those of the OpenGL registry's headers, which a test compares (gl_functions_test.cpp).

#include <cstddef>

struct osmesa_context;  // Mesa's

/// Constants: X(name, value).
#define VBAR_GL_CONSTANTS(X)            \
  X(GL_ARRAY_BUFFER, 0x8892)            \
  X(GL_CLAMP_TO_EDGE, 0x812F)           \
  X(GL_COLOR_ATTACHMENT0, 0x8CE0)       \
  X(GL_COLOR_BUFFER_BIT, 0x00004000)    \
  X(GL_COMPILE_STATUS, 0x8B81)          \
  X(GL_DEPTH_ATTACHMENT, 0x8D00)        \
  X(GL_DEPTH_BUFFER_BIT, 0x00000100)    \
  X(GL_DEPTH_CLAMP, 0x864F)             \
  X(GL_DEPTH_COMPONENT, 0x1902)         \
  X(GL_DEPTH_COMPONENT32F, 0x8CAC)      \
  X(GL_DEPTH_TEST, 0x0B71)              \
  X(GL_DRAW_FRAMEBUFFER, 0x8CA9)        \
  X(GL_FALSE, 0)                        \
  X(GL_FLOAT, 0x1406)                   \
  X(GL_FRAGMENT_SHADER, 0x8B30)         \
  X(GL_FRAMEBUFFER, 0x8D40)             \
  X(GL_FRAMEBUFFER_COMPLETE, 0x8CD5)    \
  X(GL_LINEAR, 0x2601)                  \
  X(GL_LINK_STATUS, 0x8B82)             \
  X(GL_NEAREST, 0x2600)                 \
  X(GL_NONE, 0)                         \
  X(GL_PACK_ALIGNMENT, 0x0D05)          \
  X(GL_R32F, 0x822E)                    \
  X(GL_READ_FRAMEBUFFER, 0x8CA8)        \
  X(GL_RED, 0x1903)                     \
  X(GL_RENDERBUFFER, 0x8D41)            \
  X(GL_SCISSOR_TEST, 0x0C11)            \
  X(GL_STATIC_DRAW, 0x88E4)             \
  X(GL_TEXTURE0, 0x84C0)                \
  X(GL_TEXTURE1, 0x84C1)                \
  X(GL_TEXTURE_1D, 0x0DE0)              \
  X(GL_TEXTURE_2D, 0x0DE1)              \
  X(GL_TEXTURE_MAG_FILTER, 0x2800)      \
  X(GL_TEXTURE_MIN_FILTER, 0x2801)      \
  X(GL_TEXTURE_WRAP_S, 0x2802)          \
  X(GL_TRIANGLES, 0x0004)               \
  X(GL_TRUE, 1)                         \
  X(GL_UNSIGNED_BYTE, 0x1401)           \
  X(GL_VERTEX_SHADER, 0x8B31)           \
  X(OSMESA_ACCUM_BITS, 0x32)            \
  X(OSMESA_CONTEXT_MAJOR_VERSION, 0x36) \
  X(OSMESA_CONTEXT_MINOR_VERSION, 0x37) \
  X(OSMESA_CORE_PROFILE, 0x34)          \
  X(OSMESA_DEPTH_BITS, 0x30)            \
  X(OSMESA_FORMAT, 0x22)                \
  X(OSMESA_PROFILE, 0x33)               \
  X(OSMESA_RGBA, 0x1908)                \
  X(OSMESA_STENCIL_BITS, 0x31)

/// Functions: X(result, name, (parameters)).
#define VBAR_GL_FUNCTIONS(X)                                                                               \
  X(OSMesaContext, OSMesaCreateContextAttribs, (const int*, OSMesaContext))                                \
  X(void, OSMesaDestroyContext, (OSMesaContext))                                                           \
  X(GLboolean, OSMesaMakeCurrent, (OSMesaContext, void*, GLenum, GLsizei, GLsizei))                        \
  X(void, glActiveTexture, (GLenum))                                                                       \
  X(void, glAttachShader, (GLuint, GLuint))                                                                \
  X(void, glBindBuffer, (GLenum, GLuint))                                                                  \
  X(void, glBindFramebuffer, (GLenum, GLuint))                                                             \
  X(void, glBindRenderbuffer, (GLenum, GLuint))                                                            \
  X(void, glBindTexture, (GLenum, GLuint))                                                                 \
  X(void, glBindVertexArray, (GLuint))                                                                     \
  X(void, glBlitFramebuffer, (GLint, GLint, GLint, GLint, GLint, GLint, GLint, GLint, GLbitfield, GLenum)) \
  X(void, glBufferData, (GLenum, GLsizeiptr, const void*, GLenum))                                         \
  X(GLenum, glCheckFramebufferStatus, (GLenum))                                                            \
  X(void, glClear, (GLbitfield))                                                                           \
  X(void, glCompileShader, (GLuint))                                                                       \
  X(GLuint, glCreateProgram, ())                                                                           \
  X(GLuint, glCreateShader, (GLenum))                                                                      \
  X(void, glDeleteBuffers, (GLsizei, const GLuint*))                                                       \
  X(void, glDeleteFramebuffers, (GLsizei, const GLuint*))                                                  \
  X(void, glDeleteProgram, (GLuint))                                                                       \
  X(void, glDeleteRenderbuffers, (GLsizei, const GLuint*))                                                 \
  X(void, glDeleteShader, (GLuint))                                                                        \
  X(void, glDeleteTextures, (GLsizei, const GLuint*))                                                      \
  X(void, glDeleteVertexArrays, (GLsizei, const GLuint*))                                                  \
  X(void, glDisable, (GLenum))                                                                             \
  X(void, glDrawArrays, (GLenum, GLint, GLsizei))                                                          \
  X(void, glDrawBuffer, (GLenum))                                                                          \
  X(void, glEnable, (GLenum))                                                                              \
  X(void, glEnableVertexAttribArray, (GLuint))                                                             \
  X(void, glFramebufferRenderbuffer, (GLenum, GLenum, GLenum, GLuint))                                     \
  X(void, glFramebufferTexture2D, (GLenum, GLenum, GLenum, GLuint, GLint))                                 \
  X(void, glGenBuffers, (GLsizei, GLuint*))                                                                \
  X(void, glGenFramebuffers, (GLsizei, GLuint*))                                                           \
  X(void, glGenRenderbuffers, (GLsizei, GLuint*))                                                          \
  X(void, glGenTextures, (GLsizei, GLuint*))                                                               \
  X(void, glGenVertexArrays, (GLsizei, GLuint*))                                                           \
  X(void, glGetProgramInfoLog, (GLuint, GLsizei, GLsizei*, GLchar*))                                       \
  X(void, glGetProgramiv, (GLuint, GLenum, GLint*))                                                        \
  X(void, glGetShaderInfoLog, (GLuint, GLsizei, GLsizei*, GLchar*))                                        \
  X(void, glGetShaderiv, (GLuint, GLenum, GLint*))                                                         \
  X(GLint, glGetUniformLocation, (GLuint, const GLchar*))                                                  \
  X(void, glLinkProgram, (GLuint))                                                                         \
  X(void, glPixelStorei, (GLenum, GLint))                                                                  \
  X(void, glReadBuffer, (GLenum))                                                                          \
  X(void, glReadPixels, (GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void*))                           \
  X(void, glRenderbufferStorageMultisample, (GLenum, GLsizei, GLenum, GLsizei, GLsizei))                   \
  X(void, glScissor, (GLint, GLint, GLsizei, GLsizei))                                                     \
  X(void, glShaderSource, (GLuint, GLsizei, const GLchar* const*, const GLint*))                           \
  X(void, glTexImage1D, (GLenum, GLint, GLint, GLsizei, GLint, GLenum, GLenum, const void*))               \
  X(void, glTexImage2D, (GLenum, GLint, GLint, GLsizei, GLsizei, GLint, GLenum, GLenum, const void*))      \
  X(void, glTexParameteri, (GLenum, GLenum, GLint))                                                        \
  X(void, glUniform1f, (GLint, GLfloat))                                                                   \
  X(void, glUniform1i, (GLint, GLint))                                                                     \
  X(void, glUniform2f, (GLint, GLfloat, GLfloat))                                                          \
  X(void, glUniform2fv, (GLint, GLsizei, const GLfloat*))                                                  \
  X(void, glUniform3f, (GLint, GLfloat, GLfloat, GLfloat))                                                 \
  X(void, glUniform3fv, (GLint, GLsizei, const GLfloat*))                                                  \
  X(void, glUniform4f, (GLint, GLfloat, GLfloat, GLfloat, GLfloat))                                        \
  X(void, glUniform4fv, (GLint, GLsizei, const GLfloat*))                                                  \
  X(void, glUniformMatrix3fv, (GLint, GLsizei, GLboolean, const GLfloat*))                                 \
  X(void, glUniformMatrix4fv, (GLint, GLsizei, GLboolean, const GLfloat*))                                 \
  X(void, glUseProgram, (GLuint))                                                                          \
  X(void, glVertexAttribPointer, (GLuint, GLint, GLenum, GLboolean, GLsizei, const void*))                 \
  X(void, glViewport, (GLint, GLint, GLsizei, GLsizei))

namespace vbar::opengl {

using GLenum = unsigned int;
using GLboolean = unsigned char;
using GLbitfield = unsigned int;
using GLint = int;
using GLuint = unsigned int;
using GLsizei = int;
using GLsizeiptr = std::ptrdiff_t;
using GLfloat = float;
using GLchar = char;
using OSMesaContext = ::osmesa_context*;

#define VBAR_GL_CONSTANT(name, value) inline constexpr int name = value;
VBAR_GL_CONSTANTS(VBAR_GL_CONSTANT)
#undef VBAR_GL_CONSTANT

struct GlFunctions {
#define VBAR_GL_POINTER(result, name, parameters) result(*name) parameters = nullptr;
  VBAR_GL_FUNCTIONS(VBAR_GL_POINTER)
#undef VBAR_GL_POINTER
};

/// Throws std::runtime_error if the library cannot be loaded.
const GlFunctions& gl();

}  // namespace vbar::opengl
