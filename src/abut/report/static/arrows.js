"use strict";
// Vectors on a contactor as arrows: the tangential traction. All arrows of a contactor are one mesh of flat pieces, two of
// them crossed in each arrow, so that it is seen from every side.

const ARROW = { parts: 2, corners: 7, triangles: [0, 1, 2, 0, 2, 3, 4, 5, 6], least: 0.02 };

class Arrows {
  constructor(item, flat, cut) {
    this.item = item;
    this.flat = flat;
    this.points = unpack(item.arrows.points);
    this.normals = unpack(item.arrows.normals);
    const count = this.points.length / 3, each = ARROW.parts * ARROW.corners, index = [];
    for (let i = 0; i < count * ARROW.parts; i++) index.push(...ARROW.triangles.map((k) => i * ARROW.corners + k));
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * count * each), 3));
    this.geometry.setIndex(index);
    this.mesh = new THREE.Mesh(this.geometry, new THREE.ShaderMaterial({
      side: THREE.DoubleSide, depthTest: !flat, transparent: flat,
      uniforms: { ink: { value: new THREE.Color() }, cut },
      vertexShader: `varying vec3 where; void main() { ${WHERE} gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
      fragmentShader: `uniform vec3 ink; uniform vec4 cut; varying vec3 where; void main() { ${CUT} gl_FragColor = vec4(ink, 1.0); }`,
    }));
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 3;
    this.shown = 0;
    this.length = this.fullLength();
  }

  // Twice the distance of neighbours, or a share of the contactor where it has few nodes.
  fullLength() {
    const count = this.points.length / 3, low = [Infinity, Infinity, Infinity], high = low.map((v) => -v);
    this.points.forEach((v, i) => { low[i % 3] = Math.min(low[i % 3], v); high[i % 3] = Math.max(high[i % 3], v); });
    const size = Math.hypot(...low.map((v, c) => high[c] - v));
    return Math.min(0.15 * size, (2 * size) / (this.flat ? count : Math.sqrt(count)));
  }

  values(step) {
    const own = step.contacts[this.item.number].arrows;
    own.array ||= { traction: unpack(own.traction), displacement: unpack(own.displacement) };
    return own.array;
  }

  // Size of the largest vector of a step.
  largest(step) {
    const t = this.values(step).traction;
    let top = 0;
    for (let i = 0; i < t.length; i += 3) top = Math.max(top, Math.hypot(t[i], t[i + 1], t[i + 2]));
    return top;
  }

  // Put the arrows where their nodes are at a step, deformed ``scale`` times; one of size ``largest`` has the full length.
  update(step, scale, largest) {
    const { traction, displacement } = this.values(step), position = this.geometry.attributes.position, length = this.length;
    position.array.fill(0);
    this.shown = 0;
    for (let i = 0; i < this.points.length / 3; i++) {
      const at = (list) => new THREE.Vector3(list[3 * i], list[3 * i + 1], list[3 * i + 2]);
      const t = at(traction), size = t.length() / largest;
      if (!(size > ARROW.least)) continue;
      const normal = at(this.normals), foot = at(this.points).addScaledVector(at(displacement), scale).addScaledVector(normal, 0.05 * length);
      this.one(position.array, i, foot, t.normalize(), normal, size * length);
      this.shown++;
    }
    position.needsUpdate = true;
  }

  one(array, i, foot, along, normal, length) {
    const head = 0.42 * length, thick = 0.055 * length, wide = 0.17 * length;
    const across = [new THREE.Vector3().crossVectors(along, normal), normal];
    const outline = [[0, -thick], [length - head, -thick], [length - head, thick], [0, thick], [length - head, -wide], [length, 0], [length - head, wide]];
    across.forEach((side, k) => outline.forEach(([x, y], corner) => {
      const p = foot.clone().addScaledVector(along, x).addScaledVector(side, y);
      p.toArray(array, 3 * (ARROW.corners * (ARROW.parts * i + k) + corner));
    }));
  }
}
