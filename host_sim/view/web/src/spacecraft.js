// Shapes of the spacecraft: the CAD models that cameras see, in body axes about the centre of mass.

import * as three from 'three';
import { inflate } from './run_data.js';

const linear = (rgb) => new three.Color().setRGB(...rgb.map((x) => Math.min(x, 1)), three.LinearSRGBColorSpace);

/** A surface for the eye: brighter than life, so that it can be told from the sky. */
function materialOf(material) {
  return new three.MeshPhongMaterial({ color: linear(material.diffuse.map(Math.sqrt)), specular: linear(material.specular),
                                       shininess: Math.max(material.exponent / 4, 1), side: three.DoubleSide });
}

/** The mesh of a shape of the page, in body axes. */
export async function meshOf(shape, centreOfMass) {
  const corners = new Float32Array((await inflate(shape.corners)).buffer);
  const smooth = new Int8Array((await inflate(shape.normals)).buffer);
  const material = await inflate(shape.material);
  const order = Array.from(material.keys()).sort((a, b) => material[a] - material[b]);
  const positions = new Float32Array(corners.length), normals = new Float32Array(corners.length);
  const geometry = new three.BufferGeometry();
  const a = new three.Vector3(), b = new three.Vector3(), c = new three.Vector3();
  order.forEach((from, to) => {
    const at = (k) => [corners[9 * from + k] - centreOfMass[0], corners[9 * from + k + 1] - centreOfMass[1], corners[9 * from + k + 2] - centreOfMass[2]];
    a.set(...at(0)); b.set(...at(3)); c.set(...at(6));
    positions.set([...a, ...b, ...c], 9 * to);
    const flat = c.clone().sub(b).cross(a.clone().sub(b)).normalize();
    for (let k = 0; k < 3; ++k) {
      const n = [...smooth.subarray(9 * from + 3 * k, 9 * from + 3 * k + 3)];
      normals.set(n.some((x) => x !== 0) ? n.map((x) => x / 127) : flat.toArray(), 9 * to + 3 * k);
    }
  });
  for (let begin = 0; begin < order.length;) {
    const index = material[order[begin]];
    let end = begin;
    while (end < order.length && material[order[end]] === index) ++end;
    geometry.addGroup(3 * begin, 3 * (end - begin), index);
    begin = end;
  }
  geometry.setAttribute('position', new three.BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new three.BufferAttribute(normals, 3));
  return new three.Mesh(geometry, shape.materials.map(materialOf));
}

/** A box in place of a shape that is not known. */
export function plainBody(colour) {
  const mesh = new three.Mesh(new three.BoxGeometry(0.7, 0.7, 0.7), new three.MeshPhongMaterial({ color: colour, shininess: 10 }));
  mesh.add(new three.LineSegments(new three.EdgesGeometry(mesh.geometry), new three.LineBasicMaterial({ color: 0x888888 })));
  return mesh;
}

/** The body with its axes: x red, y green, z blue. */
export async function bodyOf(run, role, colour) {
  const group = new three.Group();
  const body = run.scene?.bodies?.[role];
  const shape = body?.model ? run.scene.shapes[body.model] : undefined;
  const mesh = shape ? await meshOf(shape, body.centre_of_mass_m) : plainBody(colour), axes = new three.AxesHelper(shape ? 1.6 * shape.radius_m : 1);
  Object.assign(mesh, { castShadow: true, receiveShadow: true });
  group.add(mesh, axes);
  group.userData = { radius: shape?.radius_m ?? 0.6, name: body?.name ?? role, hasShape: Boolean(shape), axes, cameras: body?.cameras ?? [] };
  return group;
}
