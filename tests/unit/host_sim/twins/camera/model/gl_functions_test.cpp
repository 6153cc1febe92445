// The constants and functions of OpenGL as this project declares them, against the headers of the OpenGL registry and
// of Mesa.

#include "host_sim/twins/camera/model/gl_functions.h"

#include <type_traits>

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <GL/osmesa.h>
#include <gtest/gtest.h>

namespace vbar::opengl::test {
namespace {

// In the arguments of a macro, the names of constants are those of the registry.
#define VBAR_SAME_VALUE(name, value) static_assert((name) == (value));
VBAR_GL_CONSTANTS(VBAR_SAME_VALUE)

#define VBAR_SAME_TYPE(result, name, parameters) \
  static_assert(std::is_same_v<decltype(GlFunctions::name), decltype(&::name)>);
VBAR_GL_FUNCTIONS(VBAR_SAME_TYPE)

// Every function is found in the library.
TEST(GlFunctions, AreInTheLibrary) {
#define VBAR_IS_FOUND(result, name, parameters) EXPECT_NE(gl().name, nullptr) << #name;
  VBAR_GL_FUNCTIONS(VBAR_IS_FOUND)
}

}  // namespace
}  // namespace vbar::opengl::test
