// The WebGL context of the scene.

/** A WebGL context of its own canvas, smooth where a graphics processor draws it: where the browser draws by software, four
 *  samples a pixel would take 30 MB more. */
export function contextOf() {
  const options = { antialias: false, preserveDrawingBuffer: true };
  const make = (more) => document.createElement('canvas').getContext('webgl2', { ...options, ...more });
  const context = make();
  const name = context?.getParameter(context.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER) ?? '';
  if (!context || /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name)) return context;
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return make({ antialias: true });
}
