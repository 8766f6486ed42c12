"use strict";
// A mode about the state at the end of the run, as it swings.

const PHASES = 48; // of a period, in its slider and when it plays
const SWINGS = [0.02, 0.05, 0.1, 0.2, 0.4]; // largest displacement over the size of the model

// What a mode adds to the places of a part's points at a phase (0 to 1), its largest displacement being ``far``, and how far
// each point moves at most, over the largest: { add, size }.
function sway(part, mode, phase, far) {
  const own = (part.kind === "body" ? mode.bodies : mode.contacts)[part.item.number];
  const real = (own.real.array ||= unpack(own.real)), imaginary = own.imaginary ? (own.imaginary.array ||= unpack(own.imaginary)) : null;
  const c = far * Math.cos(2 * Math.PI * phase), s = far * Math.sin(2 * Math.PI * phase);
  own.size ||= Float32Array.from({ length: real.length / 3 }, (_, i) => {
    const three = (list) => Math.hypot(list[3 * i], list[3 * i + 1], list[3 * i + 2]);
    return Math.hypot(three(real), imaginary ? three(imaginary) : 0);
  });
  return { add: real.map((v, i) => c * v - (imaginary ? s * imaginary[i] : 0)), size: own.size };
}
