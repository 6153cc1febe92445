// The scene: relative motion in the RTN frame of the servicer, rotating with it or fixed, about the servicer or the target.

import * as three from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { contextOf } from './context.js';
import { displayOf, matrixOf, norm, product, scaled, times, transposed } from './frames.js';
import { bodyOf } from './spacecraft.js';
import { withUnit } from './units.js';

/** Views: what is looked at and from where; keys 1 to 7. */
export const kViews = [['both', 'Both'], ['servicer', 'Servicer'], ['target', 'Target'], ['along', 'Along T'], ['above', 'From above'], ['whole', 'Whole path'], ['camera', 'Camera']];
const kFieldDeg = 40;  // height of the field of view, but through a camera of the run
const kMinPixels = 26;  // radius at which a spacecraft is drawn at least

const vector = (a) => new three.Vector3(...a);
const cssColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Scene {
  static async make(element, runs, motions) {
    const scene = new Scene(element, runs, motions);
    await scene.#build();
    return scene;
  }

  constructor(element, runs, motions) {
    this.element = element;
    this.runs = runs;
    this.motions = motions;
    this.options = { centre: 'servicer', axes: 'rotating', view: 'both' };
    const context = contextOf();
    if (!context) throw new Error('no context of WebGL 2');
    this.renderer = new three.WebGLRenderer({ canvas: context.canvas, context, logarithmicDepthBuffer: true });
    this.renderer.setPixelRatio(devicePixelRatio);
    element.prepend(this.renderer.domElement);
    this.camera = new three.PerspectiveCamera(kFieldDeg, 1, 0.01, 1e8);
    this.camera.position.set(0.35, 0.45, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.#draw());
    this.world = new three.Scene();
    this.labels = [];
    new ResizeObserver(() => this.resize()).observe(element);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.colour(); this.rebuildPaths(); this.#draw(); });
  }

  async #build() {
    const run = this.runs[0];
    this.sunLight = new three.DirectionalLight(0xffffff, 3);
    this.ambient = new three.AmbientLight(0xffffff, 0.5);
    this.sunLight.castShadow = true;
    this.sunLight.shadow.mapSize.set(1024, 1024);
    this.world.add(this.sunLight, this.sunLight.target, this.ambient);
    this.servicer = await bodyOf(run, 'servicer', 0x7f9fd0);
    this.target = await bodyOf(run, 'target', 0xd0a060);
    this.ghosts = [];
    for (let k = 1; k < this.runs.length; ++k) {
      const ghost = await bodyOf(this.runs[k], 'target', 0xa0a0a0);
      ghost.traverse((part) => { for (const m of [part.material].flat().filter(Boolean)) { m.transparent = true; m.opacity = 0.45; } });
      this.ghosts.push(ghost);
    }
    this.world.add(this.servicer, this.target, ...this.ghosts);
    // The faces of a box are in the shadow of no other one.
    this.renderer.shadowMap.enabled = [this.servicer, this.target].some((body) => body.userData.hasShape);
    this.paths = new three.Group();
    this.world.add(this.paths);

    const sphere = new three.SphereGeometry(1, 40, 24);
    this.ellipsoid = new three.Mesh(sphere, new three.MeshBasicMaterial({ transparent: true, opacity: 0.16, depthWrite: false }));
    this.ellipsoid.add(new three.LineSegments(new three.WireframeGeometry(new three.SphereGeometry(1, 16, 10)), new three.LineBasicMaterial({ transparent: true, opacity: 0.4 })));
    this.keepOut = new three.Mesh(sphere, new three.MeshBasicMaterial({ transparent: true, opacity: 0.07, depthWrite: false }));
    this.keepOut.add(new three.LineSegments(new three.WireframeGeometry(new three.SphereGeometry(1, 24, 12)), new three.LineBasicMaterial({ transparent: true, opacity: 0.22 })));
    this.world.add(this.ellipsoid, this.keepOut);

    this.arrows = { sun: this.#arrow('Sun'), earth: this.#arrow('Earth'), r: this.#arrow('R'), t: this.#arrow('T'), n: this.#arrow('N') };
    this.commanded = new three.LineLoop(new three.BufferGeometry(), new three.LineBasicMaterial({ transparent: true, opacity: 0.9 }));
    this.commanded.frustumCulled = false;
    this.world.add(this.commanded);
    this.sight = new three.LineSegments(new three.BufferGeometry(), new three.LineBasicMaterial({ transparent: true, opacity: 0.8 }));
    this.world.add(this.sight);
    this.keypoints = new three.LineSegments(new three.BufferGeometry(), new three.LineBasicMaterial());
    this.keypoints.frustumCulled = false;
    this.world.add(this.keypoints);
    this.grid = new three.Group();
    this.world.add(this.grid);
    this.servicerLabel = this.#label('', 'craft');
    this.targetLabel = this.#label('', 'craft');
    this.estimateLabel = this.#label('', 'note');
    this.gridLabel = document.createElement('div');
    this.gridLabel.className = 'gridNote';
    this.element.append(this.gridLabel);
    this.colour();
    this.resize();
  }

  // ---- parts

  #label(text, kind) {
    const element = document.createElement('div');
    element.className = `label ${kind}`;
    element.textContent = text;
    this.element.append(element);
    const label = { element, position: new three.Vector3(), visible: true, kind };
    this.labels.push(label);
    return label;
  }

  /** An arrow of constant length on the screen. */
  #arrow(name) {
    const geometry = new three.BufferGeometry().setFromPoints([[0, 0, 0], [0, 1, 0], [0, 1, 0], [0.05, 0.86, 0], [0, 1, 0], [-0.05, 0.86, 0]].map(vector));
    const arrow = new three.LineSegments(geometry, new three.LineBasicMaterial());
    arrow.userData.label = this.#label(name, 'axis');
    this.world.add(arrow);
    return arrow;
  }

  colour() {
    this.spacing = undefined;  // the grid is made again
    const set = (object, name) => object.material.color.set(cssColour(name));
    for (const [name, variable] of [['sun', '--c3'], ['earth', '--c0'], ['r', '--muted'], ['t', '--muted'], ['n', '--muted']]) set(this.arrows[name], variable);
    for (const part of [this.ellipsoid, this.ellipsoid.children[0]]) set(part, '--c1');
    for (const part of [this.keepOut, this.keepOut.children[0]]) set(part, '--bad');
    for (const line of [this.sight, this.commanded, this.keypoints]) set(line, '--c2');
  }

  // ---- geometry in display axes

  /** To display axes from RTN at this frame. */
  #toDisplay(frame) {
    if (this.options.axes === 'rotating') return displayOf;
    const first = this.motions[0].rtnFromEciAtRow(0), fixed = product(first, transposed(frame.rtnFromEci));
    return (a) => displayOf(times(fixed, a));
  }

  /** The place of the target, or of the servicer with the target at the centre, from the target's position in RTN. */
  #placeOf(rho) { return this.options.centre === 'servicer' ? rho : scaled(-1, rho); }

  /** Places of the target at the rows with a position, three numbers each. */
  #points(motion, time, rho) {
    const points = new Float32Array(3 * time.length);
    let count = 0;
    for (let k = 0; k < time.length; ++k) {
      if (Number.isNaN(rho[0][k])) continue;
      const frame = this.options.axes === 'rotating' ? undefined : motion.frameAt(time[k]);
      points.set(this.#toDisplay(frame)(this.#placeOf([rho[0][k], rho[1][k], rho[2][k]])), 3 * count++);
    }
    return points.subarray(0, 3 * count);
  }

  #line(points, colour, opacity, dashed = false) {
    const geometry = new three.BufferGeometry().setAttribute('position', new three.BufferAttribute(points, 3));
    const line = new three.Line(geometry, dashed ? new three.LineDashedMaterial({ color: cssColour(colour), transparent: true, opacity, dashSize: 1, gapSize: 1 })
                                                 : new three.LineBasicMaterial({ color: cssColour(colour), transparent: true, opacity }));
    line.frustumCulled = false;
    this.paths.add(line);
    return line;
  }

  rebuildPaths() {
    for (const part of [...this.paths.children]) { this.paths.remove(part); part.geometry?.dispose(); }
    this.labels = this.labels.filter((label) => { if (label.kind !== 'waypoint') return true; label.element.remove(); return false; });
    const [run, motion] = [this.runs[0], this.motions[0]];
    this.truePoints = this.#points(motion, motion.time, motion.rho);
    this.#line(this.truePoints, '--c0', 0.35);
    this.flown = this.#line(this.truePoints, '--c0', 1);
    if (motion.estimate?.rho) {
      const known = this.#points(motion, motion.estimate.time, motion.estimate.rho);
      if (known.length) this.#line(known, '--c1', 0.75);
    }
    for (const other of this.motions.slice(1)) this.#line(this.#points(other, other.time, other.rho), '--c4', 0.7);
    this.#addBurns(run, motion);
    if (this.options.axes === 'rotating') this.#addWaypoints(run);
  }

  #addBurns(run, motion) {
    this.burns = [];
    const table = run.table('maneuvers');
    const dv = table?.vector('executed_dv_rtn_r_mps', 'executed_dv_rtn_t_mps', 'executed_dv_rtn_n_mps');
    if (!dv) return;
    for (let k = 0; k < table.rows; ++k) {
      const executed = dv.map((column) => column[k]), t = table.time[k], size = norm(executed);
      if (!(size > 0) || t < motion.time[0] || t > motion.time.at(-1)) continue;
      const frame = motion.frameAt(t), display = this.#toDisplay(frame);
      const geometry = new three.BufferGeometry().setFromPoints([[0, 0, 0], [0, 1, 0], [0, 1, 0], [0.1, 0.75, 0], [0, 1, 0], [-0.1, 0.75, 0]].map(vector));
      const burn = new three.LineSegments(geometry, new three.LineBasicMaterial({ color: cssColour('--c3') }));
      burn.position.copy(vector(display(this.#placeOf(frame.rho))));
      burn.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), vector(display(scaled(1 / size, executed))).normalize());
      burn.userData = { t, pixels: Math.min(Math.max(14 + 18 * (Math.log10(size) + 4), 10), 90) };
      burn.frustumCulled = false;
      this.burns.push(burn);
      this.paths.add(burn);
    }
  }

  #addWaypoints(run) {
    const table = run.table('waypoints');
    const place = table?.vector('desired_position_rtn_r_m', 'desired_position_rtn_t_m', 'desired_position_rtn_n_m');
    for (let k = 0; place && k < table.rows; ++k) {
      const label = this.#label(`${table.cells('index')[k]}`, 'waypoint');
      label.position.copy(vector(displayOf(this.#placeOf(place.map((column) => column[k])))));
      label.element.title = `waypoint ${table.cells('index')[k]}`;
    }
  }

  // ---- the instant

  show(t) {
    const motion = this.motions[0], frame = motion.frameAt(t), display = this.#toDisplay(frame);
    const place = vector(display(this.#placeOf(frame.rho)));
    const origin = new three.Vector3();
    const [atServicer, atTarget] = this.options.centre === 'servicer' ? [origin, place] : [place, origin];
    this.frame = frame;
    this.range = norm(frame.rho);
    this.t = t;
    this.servicer.position.copy(atServicer);
    this.target.position.copy(atTarget);
    this.#orient(this.servicer, motion, frame, display);
    this.#orient(this.target, motion, frame, display);
    this.ghosts.forEach((ghost, k) => {
      const other = this.motions[k + 1], there = other.frameAt(t);
      ghost.visible = t >= other.time[0] && t <= other.time.at(-1);
      const at = vector(this.#toDisplay(there)(this.#placeOf(there.rho)));
      ghost.position.copy(at);
      this.#orient(ghost, other, there, this.#toDisplay(there));
    });
    this.flown.geometry.setDrawRange(0, frame.row + 1);

    const estimate = motion.estimateAt(t);
    this.ellipsoid.visible = Boolean(estimate);
    if (estimate) {
      // Drawn about the estimate of the target; about the target, that of the servicer has the same errors.
      this.ellipsoid.position.copy(vector(display(this.#placeOf(estimate.rho))));
      this.ellipsoid.quaternion.setFromRotationMatrix(this.#matrix(display));
      this.ellipsoid.scale.set(...estimate.sigma.map((s) => Math.max(3 * s, 1e-6)));
    }
    const keepOut = this.#keepOutAt(t);
    this.keepOut.visible = keepOut > 0;
    this.keepOut.position.copy(atTarget);
    this.keepOut.scale.setScalar(Math.max(keepOut, 1e-6));
    this.keepOutRadius = keepOut;

    const orbit = motion.commandedOrbitAt(t);
    this.commanded.visible = Boolean(orbit);
    if (orbit) this.commanded.geometry.setFromPoints(orbit.map((place) => vector(display(this.#placeOf(place)))));

    const sun = motion.sunAt(t);
    this.arrows.sun.visible = Boolean(sun);
    const sunDirection = sun ? vector(display(times(frame.rtnFromEci, sun.eci))) : new three.Vector3(0.5, 1, 0.7).normalize();
    this.sunDirection = sunDirection;
    this.sunLight.intensity = 3.2 * (sun ? sun.fraction : 1);
    this.ambient.intensity = !sun ? 1.2 : this.options.view === 'camera' ? 0.15 : 0.55;
    const turn = (arrow, direction) => arrow.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), direction.clone().normalize());
    turn(this.arrows.sun, sunDirection);
    turn(this.arrows.earth, vector(display([-1, 0, 0])));
    turn(this.arrows.r, vector(display([1, 0, 0])));
    turn(this.arrows.t, vector(display([0, 1, 0])));
    turn(this.arrows.n, vector(display([0, 0, 1])));
    this.#see(motion, frame, display, atServicer);
    this.#aim(atServicer, atTarget);
    this.#draw();
  }

  /** The rotation to display axes from RTN. */
  #matrix(display) {
    return new three.Matrix4().makeBasis(...[[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => vector(display(axis))));
  }

  #orient(body, motion, frame, display) {
    const eciFromBody = motion.eciFromBody(body.userData.name, frame.t);
    body.userData.hasAttitude = Boolean(eciFromBody);
    // The display axes of RTN are a rotation; without attitudes the body axes are those of RTN.
    const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => (eciFromBody ? times(frame.rtnFromEci, times(eciFromBody, axis)) : axis));
    body.quaternion.setFromRotationMatrix(new three.Matrix4().makeBasis(...axes.map((axis) => vector(display(axis)))));
  }

  #keepOutAt(t) {
    const scene = this.runs[0].scene;
    if (!scene?.waypoints) return 0;
    return scene.waypoints.find((waypoint) => waypoint.time_s >= t)?.keep_out_m ?? scene.keep_out_m ?? 0;
  }

  /** The camera that the target fits into, the one of the narrowest field of view first; undefined without cameras. */
  #eye() {
    const cameras = [...this.servicer.userData.cameras].sort((a, b) => a.tan_half_height - b.tan_half_height);
    return cameras.find((camera) => this.target.userData.radius < this.range * camera.tan_half_height) ?? cameras.at(-1);
  }

  /** The field of view of the camera, out to the range of the target, and the view through it. */
  #see(motion, frame, display, atServicer) {
    const camera = this.#eye(), eciFromBody = motion.eciFromBody(this.servicer.userData.name, frame.t);
    this.sight.visible = Boolean(camera && eciFromBody);
    this.keypoints.visible = this.sight.visible && this.options.view === 'camera';
    this.eye = undefined;
    if (!this.sight.visible) return;
    const bodyFromCamera = transposed(matrixOf(camera.q_camera_body));
    const ofBody = (a) => vector(display(times(frame.rtnFromEci, times(eciFromBody, a))));
    const direction = (x, y, z) => ofBody(times(bodyFromCamera, [x, y, z]));
    const lens = atServicer.clone().add(ofBody(camera.position_body_m));
    const at = (x, y) => direction(x * camera.tan_half_width, y * camera.tan_half_height, 1).multiplyScalar(this.range).add(lens);
    const corners = [at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)];
    this.#setLines(this.sight, corners.flatMap((c, k) => [lens, c, c, corners[(k + 1) % 4]]));
    this.eye = { camera, lens, axes: [direction(1, 0, 0), direction(0, -1, 0), direction(0, 0, -1)] };
    if (!this.keypoints.visible) return;
    const { focal_length_px: focal, principal_point_px: [cx, cy] } = camera, arm = 0.02 * focal * camera.tan_half_height;
    const pixel = (x, y) => direction((x - cx) / focal, (y - cy) / focal, 1).multiplyScalar(0.5 * this.range).add(lens);
    this.#setLines(this.keypoints, this.#measuredAt(frame.t).flatMap(([x, y]) => [pixel(x - arm, y), pixel(x + arm, y), pixel(x, y - arm), pixel(x, y + arm)]));
  }

  #setLines(lines, points) {
    lines.geometry.dispose();
    lines.geometry = new three.BufferGeometry().setFromPoints(points);
  }

  /** The keypoints that navigation used of the last image until an instant; of a table that is in the page in part, only
   *  those of images with a picture are complete. */
  #measuredAt(t) {
    const table = this.runs[0].table('keypoints'), row = table?.rowAt(t) ?? -1;
    if (row < 0) return [];
    const [image, x, y] = table.vector('image', 'x_px', 'y_px'), fates = table.cells('fate');
    if (table.rows !== table.rowsOfFile && !this.runs[0].pictures.some((picture) => picture.image === image[row])) return [];
    const found = [];
    for (let k = row; k >= 0 && image[k] === image[row]; --k)
      if (fates[k] === 'used') found.push([x[k], y[k]]);
    return found;
  }

  // ---- the camera

  setView(view) {
    this.options.view = view;
    const directions = { along: [-1, 0.02, 0.02], above: [0, 1, 0.001], whole: [0, 0.25, 1], camera: [1, 0, 0], both: [0.12, 0.3, 1], servicer: [0.5, 0.4, 1], target: [0.5, 0.4, 1] };
    this.aimed = undefined;
    this.direction = vector(directions[view]).normalize();
    if (this.frame) this.show(this.t);
  }

  set(options) {
    Object.assign(this.options, options);
    this.rebuildPaths();
    this.setView(this.options.view);
  }

  /** Keeps what the view is about in the middle, at a distance in proportion to its size; the user's zoom and direction
   *  stay. */
  #aim(atServicer, atTarget) {
    const view = this.options.view;
    const through = this.through = view === 'camera' && Boolean(this.eye);
    const { sun, ...others } = this.arrows;
    for (const part of [this.servicer, this.paths, this.grid, ...Object.values(others)]) part.visible = !through;
    for (const part of [sun, this.commanded, this.keepOut]) part.visible &&= !through;
    for (const body of [this.target, ...this.ghosts]) body.userData.axes.visible = !through;
    this.controls.enabled = !through;
    this.world.background = new three.Color(through ? 0x000000 : cssColour('--sky'));
    this.element.classList.toggle('through', through);
    if (through) return this.#lookThrough(atTarget);
    this.camera.fov = kFieldDeg;
    let centre, size;
    if (view === 'whole') {
      const box = new three.Box3().setFromArray(this.truePoints).expandByPoint(new three.Vector3());
      centre = box.getCenter(new three.Vector3());
      size = 0.62 * box.getSize(new three.Vector3()).length();
    } else if (view === 'servicer' || view === 'target') {
      const body = this[view];
      centre = body.position.clone();
      size = 2 * body.userData.radius;
    } else {
      centre = atServicer.clone().add(atTarget).multiplyScalar(0.5);
      size = Math.max(0.62 * this.range, 1.5);
    }
    if (!this.aimed) {
      this.camera.position.copy(centre).addScaledVector(this.direction, 2.4 * size);
    } else {
      const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(size / this.aimed.size);
      this.camera.position.copy(centre).add(offset);
    }
    this.controls.target.copy(centre);
    this.aimed = { size };
    this.camera.near = size * 1e-4;
    this.camera.far = size * 1e4 + 1e6;
    this.camera.updateProjectionMatrix();
    this.updating = true;
    this.controls.update();
    this.updating = false;
  }

  /** The image of the camera of the run in the middle, whole; without the distortion of its lens. */
  #lookThrough(atTarget) {
    const { camera, lens, axes } = this.eye;
    this.aimed = undefined;
    this.camera.position.copy(lens);
    this.camera.quaternion.setFromRotationMatrix(new three.Matrix4().makeBasis(...axes));
    this.camera.fov = (360 / Math.PI) * Math.atan(1.04 * Math.max(camera.tan_half_height, camera.tan_half_width / this.camera.aspect));
    this.camera.near = Math.max(1e-3 * this.range, 0.02);
    this.camera.far = 10 * this.range;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(atTarget);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.through) this.show(this.t);
    else this.#draw();
  }

  /** m a pixel at a place. */
  #metresPerPixel(place) {
    return (2 * Math.tan((this.camera.fov * Math.PI) / 360) * Math.max(this.camera.position.distanceTo(place), 1e-9)) / this.element.clientHeight;
  }

  /** Draws with the next frame of the browser, however often it is asked to before. */
  #draw() {
    if (this.updating || !this.frame || this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.#render();
    });
  }

  #render() {
    for (const body of [this.servicer, this.target, ...this.ghosts]) {
      const scale = this.through ? 1 : Math.max((kMinPixels * this.#metresPerPixel(body.position)) / body.userData.radius, 1);
      body.scale.setScalar(scale);
      body.userData.scale = scale;
    }
    this.#shine(this.options.view === 'servicer' ? this.servicer : this.target);
    const perPixel = this.#metresPerPixel(this.controls.target);
    const origin = this.options.centre === 'servicer' ? this.servicer.position : this.target.position;
    for (const [name, arrow] of Object.entries(this.arrows)) {
      const isAxis = name.length === 1;
      arrow.position.copy(origin);
      arrow.scale.setScalar((isAxis ? 60 : 100) * this.#metresPerPixel(origin));
      arrow.userData.label.position.copy(new three.Vector3(0, 1.12, 0).applyQuaternion(arrow.quaternion).multiplyScalar(arrow.scale.x).add(arrow.position));
      arrow.userData.label.visible = arrow.visible;
    }
    for (const burn of this.burns) {
      burn.scale.setScalar(burn.userData.pixels * this.#metresPerPixel(burn.position));
      burn.material.opacity = burn.userData.t <= this.t ? 1 : 0.35;
      burn.material.transparent = true;
    }
    this.#drawGrid(perPixel);
    this.#describe();
    this.renderer.render(this.world, this.camera);
    this.#placeLabels();
  }

  /** The light of the Sun, with the shadows of a body on itself and on what is beside it. */
  #shine(body) {
    const reach = 1.6 * body.userData.radius * body.userData.scale, { shadow } = this.sunLight;
    this.sunLight.target.position.copy(body.position);
    this.sunLight.position.copy(body.position).addScaledVector(this.sunDirection, 4 * reach);
    Object.assign(shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: reach, far: 7 * reach });
    shadow.camera.updateProjectionMatrix();
    shadow.normalBias = reach / 300;
  }

  /** Lines in the plane of R and T, a decade apart from what a hundred pixels show. */
  #drawGrid(perPixel) {
    const spacing = 10 ** Math.ceil(Math.log10(60 * perPixel));
    if (spacing !== this.spacing) {
      this.spacing = spacing;
      this.grid.clear();
      const grid = new three.GridHelper(40 * spacing, 40);
      Object.assign(grid.material, { transparent: true, opacity: 0.16, vertexColors: false });
      grid.material.color.set(cssColour('--muted'));
      grid.rotation.x = Math.PI / 2;
      this.grid.add(grid);
    }
    const snap = (x) => Math.round(x / spacing) * spacing;
    this.grid.position.set(snap(this.controls.target.x), snap(this.controls.target.y), 0);
  }

  #describe() {
    const enlarged = (body) => (body.userData.scale > 1.05 ? ` ×${body.userData.scale >= 10 ? Math.round(body.userData.scale) : body.userData.scale.toFixed(1)}` : '');
    const without = (body) => (body.userData.hasShape ? '' : ', no model');
    this.servicerLabel.element.textContent = `${this.servicer.userData.name}${enlarged(this.servicer)}${without(this.servicer)}`;
    this.servicerLabel.position.copy(this.servicer.position);
    this.targetLabel.element.textContent = `${this.target.userData.name}${enlarged(this.target)}${without(this.target)}`;
    this.targetLabel.position.copy(this.target.position);
    this.targetLabel.visible = !this.through || this.target.userData.radius < 20 * this.#metresPerPixel(this.target.position);
    this.estimateLabel.visible = this.ellipsoid.visible;
    this.estimateLabel.element.textContent = '3σ';
    this.estimateLabel.position.copy(new three.Vector3(1, 0, 0).applyQuaternion(this.ellipsoid.quaternion).multiplyScalar(this.ellipsoid.scale.x).add(this.ellipsoid.position));
    if (this.estimateLabel.position.distanceTo(this.target.position) < 12 * this.#metresPerPixel(this.target.position)) this.estimateLabel.visible = false;
    const keepOut = this.keepOut.visible ? `, keep-out ${withUnit(this.keepOutRadius, 'm', 3)}` : '';
    if (this.through) this.gridLabel.textContent = `through ${this.eye.camera.name} of the ${this.servicer.userData.name}${this.keypoints.geometry.attributes.position?.count ? ', keypoints that navigation used of the last image (green)' : ''}`;
    else this.gridLabel.textContent = `RTN ${this.options.axes}, about ${this.runs[0].isPropagation ? '' : 'the '}${this[this.options.centre].userData.name} · grid ${this.spacing >= 1000 ? `${this.spacing / 1000} km` : `${+this.spacing.toPrecision(3)} m`}${keepOut}`;
  }

  #placeLabels() {
    const { clientWidth: width, clientHeight: height } = this.element;
    const [above, below] = [this.servicerLabel, this.targetLabel].map((label) => label.position.clone().project(this.camera));
    // Names of spacecraft that are beside each other stand one below the other.
    const isNear = Math.abs(above.x - below.x) * width < 340 && Math.abs(above.y - below.y) * height < 28;
    this.targetLabel.element.style.marginTop = isNear ? '15px' : '';
    for (const { element, position, visible, kind } of this.labels) {
      const p = position.clone().project(this.camera);
      const shown = visible && !(this.through && (kind === 'waypoint' || element === this.servicerLabel.element)) && p.z < 1 && Math.abs(p.x) < 1.05 && Math.abs(p.y) < 1.05;
      element.style.display = shown ? '' : 'none';
      if (shown) element.style.transform = `translate(${((p.x + 1) * width) / 2}px, ${((1 - p.y) * height) / 2}px)`;
    }
  }
}
