"use strict";
// The picture: camera, what is shown of each part, colours.

const RAW = "srgb-linear"; // colours go to the screen as they are written, without three's conversion

class View {
  constructor(holder, scene) {
    this.holder = holder;
    this.data = scene;
    this.flat = scene.dim === 2;
    scene.bodies.forEach((b, i) => { b.number = i; });
    scene.contacts.forEach((c, i) => { c.number = i; });
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    holder.prepend(this.renderer.domElement);
    this.world = new THREE.Scene();
    this.cut = { value: [0, 0, 0, 1] }; // the plane of the section (normal, constant), which all materials share
    this.bodies = scene.bodies.map((b) => new Part(b, "body", this.flat, scene.finite, this.cut));
    this.sides = scene.contacts.map((c) => new Part(c, this.flat ? "fence" : "side", this.flat, scene.finite, this.cut));
    if (this.flat) this.sides.forEach((s) => { if (s.item.role !== "contactor") s.mesh.visible = s.grid.visible = false; });
    for (const part of [...this.bodies, ...this.sides]) this.world.add(part.mesh, part.features, part.grid);
    this.arrows = scene.contacts.filter((c) => c.arrows).map((c) => new Arrows(c, this.flat, this.cut));
    for (const own of this.arrows) this.world.add(own.mesh);
    this.caps = this.bodies.filter((b) => b.item.inside.count).map((b) => new Cap(b));
    for (const cap of this.caps) this.world.add(cap.mesh);
    this.copies = []; // mirrored: { reflection, meshes: [[original, copy]], caps }
    this.state = {
      step: scene.steps.length - 1, scale: 1, bands: false, mesh: this.triangles() < 40000, arrows: !this.flat,
      field: scene.contacts.length ? (this.flat ? "von Mises" : "pressure") : "von Mises",
      bodies: this.bodies.map(() => "solid"), sides: this.sides.map((s) => s.item.role === "contactor"), range: {},
      mode: -1, phase: 0, swing: 0.1, of: 0, section: { axis: "", at: 0.5, other: false }, mirrors: scene.mirrors.map(() => false),
    };
    if (!this.flat) this.ghostTargets();
    this.maps = Object.fromEntries(Object.entries(MAPS).map(([name, stops]) => [name, ramp(stops)]));
    this.measure();
    this.camera = this.flat ? new THREE.OrthographicCamera() : new THREE.PerspectiveCamera(28, 1, 1e-3 * this.size, 100 * this.size);
    this.camera.up.set(0, this.flat ? 1 : 0, this.flat ? 0 : 1);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.draw());
    if (this.flat) {
      this.controls.enableRotate = false;
      this.controls.mouseButtons.LEFT = 2;
      this.controls.touches.ONE = 1;
    }
    new ResizeObserver(() => this.resize()).observe(holder);
    this.resize();
    if (!this.flat && this.pressed) this.findContact();
    this.apply();
    this.look("start");
  }

  // The first view shows the contact: from where it is seen, with what hides it faded, or cut away.
  findContact() {
    const found = sight(this, this.data.steps.at(-1), this.largest("pressure"));
    if (!found) return;
    this.from = found.from;
    for (const body of found.fade) this.state.bodies[body] = "ghost";
    if (!found.cut) return;
    const axis = ["x", "y", "z"].reduce((a, b) => Math.abs(found.from[b]) > Math.abs(found.from[a]) ? b : a);
    const k = "xyz".indexOf(axis), [low, high] = [this.box[0][k], this.box[1][k]];
    Object.assign(this.state.section, { axis, at: (this.pressed.centre[axis] - low) / (high - low || 1), other: found.from[axis] < 0 });
  }

  largest(name) { return (this.data.ranges[name] || [[0, 0]])[0][1]; }

  triangles() { return this.bodies.reduce((n, p) => n + p.map.length / 3, 0); }

  // The target is in the way of the contactor's pressure: it is drawn as a ghost, unless it is a contactor too.
  ghostTargets() {
    const pressed = new Set(this.sides.filter((s) => s.item.role === "contactor").map((s) => s.item.body));
    for (const s of this.sides) if (!pressed.has(s.item.body)) this.state.bodies[s.item.body] = "ghost";
  }

  // Size and middle of everything, and of the pressed parts; the direction from which these are seen.
  measure() {
    const low = [Infinity, Infinity, Infinity], high = low.map((v) => -v);
    const reach = (x) => {
      for (let i = 0; i < x.length; i++) {
        low[i % 3] = Math.min(low[i % 3], x[i]);
        high[i % 3] = Math.max(high[i % 3], x[i]);
      }
    };
    const place = (part, step) => part.moved(step, this.data.finite ? 1 : 0);
    for (const part of [...this.bodies, ...this.sides]) {
      reach(part.base);
      if (this.data.finite) for (const step of this.data.steps) reach(place(part, step));
    }
    this.box = [low, high];
    this.centre = new THREE.Vector3(...low.map((v, c) => 0.5 * (v + high[c])));
    this.size = Math.hypot(...low.map((v, c) => high[c] - v)) || 1;
    const last = this.data.steps[this.data.steps.length - 1];
    const sum = new THREE.Vector3(), middle = new THREE.Vector3();
    const zone = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    let weight = 0;
    for (const part of this.sides.filter((s) => s.item.role === "contactor")) {
      const base = place(part, last), p = part.field(last, "pressure"), normals = unpack(part.item.normals);
      const top = Math.min(p.reduce((a, b) => Math.max(a, b || 0), 0), this.largest("pressure"));
      for (let i = 0; i < p.length; i++) {
        if (!(p[i] > 0.01 * top)) continue;
        const x = Array.from(base.subarray(3 * i, 3 * i + 3));
        x.forEach((v, c) => { zone[0][c] = Math.min(zone[0][c], v); zone[1][c] = Math.max(zone[1][c], v); });
        sum.add(new THREE.Vector3(...normals.subarray(3 * i, 3 * i + 3)).multiplyScalar(p[i]));
        middle.add(new THREE.Vector3(...x).multiplyScalar(p[i]));
        weight += p[i];
      }
    }
    this.pressed = weight > 0 ? { centre: middle.divideScalar(weight), size: Math.hypot(...zone[0].map((v, c) => zone[1][c] - v)) || 0.1 * this.size } : null;
    const across = new THREE.Vector3(0.5, -0.75, 0.5);
    this.facing = weight > 0 && sum.length() > 1e-6 * weight ? sum.normalize() : null;
    if (this.facing && Math.abs(this.facing.z) > 0.8) across.z = 0;
    this.from = this.facing ? this.facing.clone().multiplyScalar(0.62).addScaledVector(across, 0.9) : new THREE.Vector3(0.6, -1, 0.55);
    this.from.normalize();
    const largest = Math.max(...[...this.bodies].map((b) => b.field(last, "displacement").reduce((a, v) => Math.max(a, v), 0)), 0);
    const limit = largest > 0 ? (0.1 * this.size) / largest : 1;
    this.scales = [0, 1];
    for (let power = 1; power < 1e9 && this.scales.at(-1) < limit; power *= 10) this.scales.push(2 * power, 5 * power, 10 * power);
    while (this.scales.length > 2 && this.scales.at(-2) > limit) this.scales.pop();
  }

  look(name) {
    const directions = { x: [1, 0, 0], y: [0, -1, 0], z: [0, 0, 1], corner: [0.6, -1, 0.55] };
    const small = name === "start" && this.pressed && this.pressed.size < 0.12 * this.size && !this.flat;
    const contact = (name === "contact" || small) && this.pressed;
    const centre = (contact ? this.pressed.centre : this.centre).clone();
    const extent = contact ? (small ? 5 : 1.6) * this.pressed.size : this.size;
    if (this.flat) {
      const [low, high] = this.box, aspect = this.aspect || 1;
      const half = contact ? 0.5 * extent : 0.54 * Math.max(high[1] - low[1], (high[0] - low[0]) / aspect);
      this.camera.zoom = 1;
      Object.assign(this.camera, { top: half, bottom: -half, left: -half * aspect, right: half * aspect, near: -this.size, far: this.size });
      this.half = half;
      this.camera.position.set(centre.x, centre.y, 0.5 * this.size);
    } else {
      const from = directions[name] ? new THREE.Vector3(...directions[name]).normalize() : this.from;
      const far = contact ? (0.55 * extent) / Math.tan((14 * Math.PI) / 180) : this.distance(from);
      this.camera.position.copy(centre).addScaledVector(from, far);
    }
    this.controls.target.copy(centre);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  // How far away the camera must be to see all corners of the box.
  distance(from) {
    const right = new THREE.Vector3(0, 0, 1).cross(from);
    if (right.length() < 1e-6) right.set(1, 0, 0);
    const up = from.clone().cross(right.normalize()), tangent = Math.tan((14 * Math.PI) / 180);
    let far = 0;
    for (let i = 0; i < 8; i++) {
      const corner = new THREE.Vector3(...[0, 1, 2].map((c) => this.box[(i >> c) & 1][c])).sub(this.centre);
      const wide = Math.max(Math.abs(corner.dot(right)) / (this.aspect || 1), Math.abs(corner.dot(up))) / tangent;
      far = Math.max(far, wide + corner.dot(from));
    }
    return 1.06 * far;
  }

  resize() {
    const width = this.holder.clientWidth, height = this.holder.clientHeight;
    if (!width || !height) return;
    this.aspect = width / height;
    this.renderer.setSize(width, height, false);
    if (this.flat && this.half) Object.assign(this.camera, { left: -this.half * this.aspect, right: this.half * this.aspect });
    else this.camera.aspect = this.aspect;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  // Modes are about the state at the end.
  get step() { return this.state.mode < 0 ? this.data.steps[this.state.step] : this.data.steps.at(-1); }

  // Least and largest value of a field at the nodes over all steps, of all bodies or of the one that is chosen.
  extent(name) {
    if (name === "status") return [-0.5, 2.5];
    const known = this.data.ranges[name] || [];
    let [low, high] = known[this.state.of] || known[0] || [0, 1];
    if (FROM_ZERO.includes(name)) low = 0;
    if (high <= 0 && low === 0) high = 1;
    if (name === "gap" && high < 1e-9 * this.size) [low, high] = [0, 1e-9 * this.size]; // rounding
    return [low, high];
  }

  range(name) { return this.state.range[name] || this.extent(name); }

  // Everything on the screen follows from the state.
  apply() {
    const s = this.state, [low, high] = this.range(s.field);
    const [, tallest] = this.extent(this.fence());
    const height = tallest > 0 ? (0.12 * this.size) / tallest : 0;
    const onBodies = ON_BODIES.includes(s.field), mode = this.data.modes[s.mode];
    for (const part of [...this.bodies, ...this.sides]) part.sway = mode ? sway(part, mode, s.phase, s.swing * this.size) : null;
    for (const part of this.bodies) part.update(this.step, s.scale, s.field, "", 0);
    for (const part of this.sides) part.update(this.step, s.scale, this.flat && onBodies ? this.fence() : s.field, this.fence(), height);
    this.drawArrows();
    this.section();
    const style = (part, body, coloured, shown) => {
      const u = part.mesh.material.uniforms, how = s.bodies[body];
      const ghost = how === "ghost" && !shown;
      part.mesh.visible = shown || how !== "hidden";
      Object.assign(part.mesh.material, { transparent: ghost, depthWrite: !ghost });
      u.opacity.value = ghost ? 0.12 : 1;
      u.plain.value.setStyle(colour("body" + (1 + (body % 4))), RAW);
      u.coloured.value = coloured && !ghost ? 1 : 0;
      u.map.value = this.maps[s.field];
      u.low.value = low;
      u.high.value = high;
      u.bands.value = s.field === "status" ? STATUS.length : s.bands ? 12 : 0;
      u.nothing.value = FROM_ZERO.includes(s.field) ? 1e-3 * high : -1e30;
      const ink = document.documentElement.dataset.theme === "dark" ? "#e8edf3" : "#1a222c";
      for (const lines of [part.features, part.grid]) lines.material.uniforms.ink.value.setStyle(ink, RAW);
      part.features.material.uniforms.opacity.value = ghost ? 0.35 : 0.75;
      part.grid.material.uniforms.opacity.value = Math.min(0.3, 18 / Math.sqrt(this.triangles()));
      part.features.visible = part.mesh.visible;
      part.grid.visible = part.mesh.visible && s.mesh && !ghost;
    };
    for (const part of this.bodies) style(part, part.item.number, onBodies, false);
    this.sides.forEach((part, i) => {
      style(part, part.item.body, s.sides[i] || onBodies, s.sides[i]);
      if (!this.flat) return;
      const u = part.mesh.material.uniforms, same = !onBodies;
      part.mesh.visible = part.grid.visible = s.sides[i] && part.item.role === "contactor";
      part.grid.material.uniforms.opacity.value = 0.8;
      Object.assign(part.mesh.material, { transparent: true, depthTest: false });
      part.mesh.renderOrder = part.grid.renderOrder = 2;
      u.opacity.value = same ? 0.95 : 0.55;
      u.coloured.value = same ? 1 : 0;
      if (!same) u.plain.value.setStyle(colour("second"), RAW);
    });
    for (const own of [{ caps: this.caps, meshes: [] }, ...this.copies]) {
      for (const cap of own.caps) {
        const from = cap.part.mesh.material.uniforms, to = cap.mesh.material.uniforms;
        for (const name of ["plain", "map", "low", "high", "bands", "nothing"]) to[name].value = from[name].value;
        to.coloured.value = onBodies ? 1 : 0;
        cap.mesh.visible = Boolean(s.section.axis) && s.bodies[cap.part.item.number] === "solid";
      }
      for (const [mesh, copy] of own.meshes) Object.assign(copy, { visible: mesh.visible, renderOrder: mesh.renderOrder });
    }
    this.draw();
  }

  // The plane of the section, and what bodies show on it.
  section() {
    const { axis, at, other } = this.state.section, k = "xyz".indexOf(axis), sign = other ? -1 : 1;
    if (!axis) {
      this.cut.value = [0, 0, 0, 1];
      return;
    }
    const level = this.box[0][k] + at * (this.box[1][k] - this.box[0][k]), plane = [0, 1, 2].map((c) => c === k ? sign : 0);
    this.cut.value = [...plane, sign * level];
    for (const own of [{ caps: this.caps }, ...this.copies]) {
      for (const cap of own.caps) {
        const here = own.reflection ? own.reflection.plane(this.cut.value) : this.cut.value;
        if (this.state.bodies[cap.part.item.number] === "solid") cap.update(here, cap.part.field(this.step, this.state.field));
      }
    }
  }

  // The whole of a model of which a half, a quarter or an eighth was solved.
  mirror() {
    for (const own of this.copies) for (const mesh of [...own.meshes.map(([, copy]) => copy), ...own.caps.map((cap) => cap.mesh)]) this.world.remove(mesh);
    const parts = [...this.bodies, ...this.sides].flatMap((p) => [p.mesh, p.features, p.grid]);
    const place = (mesh, reflection) => {
      mesh.matrixAutoUpdate = false;
      reflection.into(mesh.matrix);
      this.world.add(mesh);
      return mesh;
    };
    this.copies = reflections(this.data.mirrors.filter((_, i) => this.state.mirrors[i])).map((reflection) => ({
      reflection,
      meshes: [...parts, ...this.arrows.map((own) => own.mesh)].map((mesh) => [mesh, place(Object.assign(new mesh.constructor(mesh.geometry, mesh.material), { frustumCulled: false }), reflection)]),
      caps: this.bodies.filter((b) => b.item.inside.count).map((b) => new Cap(b)),
    }));
    for (const own of this.copies) for (const cap of own.caps) place(cap.mesh, own.reflection);
    this.enclose();
    this.apply();
    this.look("all");
  }

  // The box round everything that is drawn.
  enclose() {
    this.own ||= this.box;
    const corners = Array.from({ length: 8 }, (_, i) => [0, 1, 2].map((c) => this.own[(i >> c) & 1][c]));
    const all = [...corners, ...this.copies.flatMap((own) => corners.map((x) => own.reflection.point(x)))];
    this.box = [Math.min, Math.max].map((f) => [0, 1, 2].map((c) => f(...all.map((x) => x[c]))));
    this.centre = new THREE.Vector3(...this.box[0].map((v, c) => 0.5 * (v + this.box[1][c])));
  }

  // Whether any contact surface has a field.
  has(name) { return this.sides.some((part) => part.field(this.step, name)); }

  // What is drawn across the contactor's line in 2D.
  fence() { return [...ON_BODIES, "status"].includes(this.state.field) ? "pressure" : this.state.field; }

  // The tangential traction on the contactors that are shown.
  drawArrows() {
    const s = this.state;
    this.most ||= Math.max(0, ...this.arrows.flatMap((own) => this.data.steps.map((step) => own.largest(step))));
    for (const own of this.arrows) {
      own.mesh.visible = s.arrows && s.mode < 0 && s.sides[own.item.number] && this.most > 0;
      own.mesh.material.uniforms.ink.value.setStyle(s.field === "pressure" ? "#22c7e8" : "#12181f", RAW);
      if (own.mesh.visible) own.update(this.step, s.scale, this.most);
    }
  }

  draw() { this.renderer.render(this.world, this.camera); }

  // The value under the pointer: part, place, value.
  pick(x, y) {
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(2 * x - 1, 1 - 2 * y), this.camera);
    const parts = [...this.sides, ...this.bodies].filter((p) => p.mesh.visible && !(p.kind === "body" && this.state.bodies[p.item.number] === "ghost"));
    const copies = new Map(this.copies.flatMap((own) => own.meshes.map(([mesh, copy]) => [copy, [mesh, own.reflection]])));
    const shown = parts.map((p) => p.mesh), [a, b, c, level] = this.cut.value;
    const meshes = [...shown, ...[...copies].filter(([, [mesh]]) => shown.includes(mesh)).map(([copy]) => copy)];
    const hit = ray.intersectObjects(meshes, false).find((one) => a * one.point.x + b * one.point.y + c * one.point.z <= level);
    if (!hit) return null;
    const [origin, reflection] = copies.get(hit.object) || [hit.object, new Reflection([])];
    const part = origin.userData.part, place = part.geometry.attributes.position.array, here = reflection.point(hit.point.toArray());
    const corners = [hit.face.a, hit.face.b, hit.face.c];
    const nearest = corners.reduce((best, k) => {
      const d = Math.hypot(...[0, 1, 2].map((c) => place[3 * k + c] - here[c]));
      return d < best[0] ? [d, k] : best;
    }, [Infinity, 0])[1];
    const k = part.map[nearest], values = {};
    for (const name of Object.keys(MAPS)) {
      const field = part.field(this.step, name);
      if (field && !Number.isNaN(field[k])) values[name] = field[k];
    }
    return { name: part.kind === "body" ? part.item.name : part.item.surface, point: Array.from(part.base.subarray(3 * k, 3 * k + this.data.dim)), values };
  }

  // How much is drawn: pixels that are not empty and how many colours they have, for tests.
  count() {
    this.draw();
    const gl = this.renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, data = new Uint8Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, data);
    const colours = new Set();
    let pixels = 0;
    for (let i = 0; i < data.length; i += 4) {
      if (!data[i + 3]) continue;
      pixels++;
      colours.add((data[i] >> 3 << 10) | (data[i + 1] >> 3 << 5) | (data[i + 2] >> 3));
    }
    return { pixels, colours: colours.size };
  }
}
