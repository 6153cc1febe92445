#include "host_sim/twins/camera/model/gl_functions.h"

#include "host_sim/io/shared_library.h"

namespace vbar::opengl {
namespace {

GlFunctions loaded_functions() {
  const io::SharedLibrary library("libOSMesa.so.8", "an image of a spacecraft", "libosmesa6");
  GlFunctions functions;
#define VBAR_GL_FIND(result, name, parameters) library.find(#name, functions.name);
  VBAR_GL_FUNCTIONS(VBAR_GL_FIND)
#undef VBAR_GL_FIND
  return functions;
}

}  // namespace

const GlFunctions& gl() {
  static const GlFunctions kFunctions = loaded_functions();
  return kFunctions;
}

}  // namespace vbar::opengl
