"use strict";
// The page: the panel beside the picture, light and dark, and what tests read off the root element.

(() => {
  const root = document.documentElement;
  const data = JSON.parse(document.getElementById("data").textContent);
  root.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";

  const element = (tag, properties = {}, ...children) => {
    const result = Object.assign(document.createElement(tag), properties);
    result.append(...children);
    return result;
  };
  const choice = (options, value, change) => {
    const select = element("select", { onchange: () => change(select.value) }, ...options.map((o) => element("option", { textContent: o })));
    select.value = value;
    return select;
  };
  const tick = (label, checked, change) => {
    const box = element("input", { type: "checkbox", checked, onchange: () => change(box.checked) });
    return element("label", {}, box, element("span", { textContent: label }));
  };
  const slider = (count, value, change) => {
    const input = element("input", { type: "range", min: 0, max: count - 1, step: 1, value, oninput: () => change(Number(input.value)) });
    return input;
  };

  // A button that runs through so many steps, from the first again after the last, until it is pressed again.
  function playing(id, what, count, time, now, go) {
    let timer = null;
    const button = element("button", { id, className: "play" });
    const show = () => {
      button.textContent = timer === null ? "▶" : "⏸";
      button.title = timer === null ? what : "pause";
    };
    const pause = () => { clearInterval(timer); timer = null; show(); };
    button.onclick = () => {
      if (timer !== null) return pause();
      timer = setInterval(() => go((now() + 1) % count), time);
      show();
    };
    show();
    return { button, pause };
  }

  function colourBar(view) {
    const canvas = element("canvas", { width: 1, height: 256 });
    const input = (index) => {
      const own = element("input", { type: "number", step: "any", title: "type another limit; empty it for the computed one" });
      own.onchange = () => {
        const s = view.state, range = [...view.range(s.field)];
        range[index] = own.value === "" ? view.extent(s.field)[index] : Number(own.value);
        s.range[s.field] = range;
        view.apply();
        show();
      };
      return own;
    };
    const [top, bottom] = [input(1), input(0)];
    const middle = [3, 2, 1].map(() => element("span"));
    const show = () => {
      const stops = MAPS[view.state.field], [low, high] = view.range(view.state.field);
      const context = canvas.getContext("2d"), gradient = context.createLinearGradient(0, 256, 0, 0);
      stops.forEach((s, i) => gradient.addColorStop(i / (stops.length - 1), "#" + s));
      context.fillStyle = gradient;
      context.fillRect(0, 0, 1, 256);
      top.value = Number(high.toPrecision(5));
      bottom.value = Number(low.toPrecision(5));
      middle.forEach((m, i) => { m.textContent = "\u2002" + short(Number((low + ((3 - i) / 4) * (high - low)).toPrecision(4))); });
    };
    const bar = element("div", { id: "bar" }, canvas, element("div", {}, top, ...middle, bottom));
    const legend = element("div", { id: "legend" }, ...STATUS.map(([name, shade]) => element("p", {}, element("i", { style: `background:#${shade}` }), name)));
    const either = () => {
      const categories = view.state.field === "status";
      bar.hidden = categories;
      legend.hidden = !categories;
      if (!categories) show();
    };
    return [element("div", {}, bar, legend), either];
  }

  function panel(view) {
    const s = view.state, scene = data.scene, at = document.getElementById("panel");
    const heading = (text) => element("h4", { textContent: text });
    const fields = Object.keys(MAPS).filter((f) => ON_BODIES.includes(f) ? f in scene.ranges : view.has(f));
    const [bar, showBar] = colourBar(view);
    const colours = choice(fields, s.field, (f) => { s.field = f; showBar(); view.apply(); });
    at.append(heading("Colour"), colours, bar);
    if (scene.bodies.length > 1) {
      const names = ["all bodies", ...scene.bodies.map((b) => b.name)], select = element("select");
      select.append(...names.map((name, i) => element("option", { textContent: name, value: i })));
      select.onchange = () => { s.of = Number(select.value); s.range = {}; showBar(); view.apply(); };
      at.append(element("label", {}, element("span", { textContent: "range of" }), select));
    }
    if (view.arrows.length) at.append(tick("arrows: tangential traction", s.arrows, (on) => { s.arrows = on; view.apply(); }));
    at.append(tick("bands of colour", s.bands, (on) => { s.bands = on; view.apply(); }));
    at.append(tick("mesh", s.mesh, (on) => { s.mesh = on; view.apply(); }));
    showBar();
    const ofModes = element("div"), ofSteps = element("div");
    let still = () => {}; // pauses the steps
    at.append(ofModes, ofSteps);
    if (scene.modes.length) {
      vibrations(view, ofModes, heading, (on) => {
        still();
        ofSteps.hidden = on;
        colours.value = s.field;
        showBar();
      });
    }
    if (scene.steps.length > 1) {
      const title = heading("");
      const name = () => { title.textContent = `Step ${view.step.number}, time ${short(view.step.time)}`; };
      const go = (i) => { s.step = i; name(); view.apply(); };
      const input = slider(scene.steps.length, s.step, (i) => { player.pause(); go(i); });
      const time = Math.min(600, Math.max(60, 6000 / scene.steps.length));
      const player = playing("play", "play the steps", scene.steps.length, time, () => s.step, (i) => { input.value = i; go(i); });
      still = player.pause;
      ofSteps.append(title, element("div", { className: "steps" }, player.button, input));
      name();
    }
    const title = heading("");
    const name = () => { title.textContent = `Deformation ×${s.scale}${s.scale === 1 ? " (true)" : ""}`; };
    at.append(title, slider(view.scales.length, view.scales.indexOf(1), (i) => { s.scale = view.scales[i]; name(); view.apply(); }));
    name();
    if (!view.flat) sections(view, at, heading);
    if (scene.mirrors.length) at.append(heading("Mirrored at"));
    scene.mirrors.forEach((plane, i) => {
      const axis = plane.slice(0, 3).findIndex((v) => Math.abs(v) > 1 - 1e-9);
      const label = axis < 0 ? `normal (${plane.slice(0, 3).map(short).join(", ")})` : `${"xyz"[axis]} = ${short(plane[axis] * plane[3] || 0)}`;
      at.append(tick(label, false, (on) => { s.mirrors[i] = on; view.mirror(); }));
    });
    at.append(heading("Bodies"));
    scene.bodies.forEach((b, i) => {
      const how = view.flat ? ["solid", "hidden"] : ["solid", "ghost", "hidden"];
      const select = choice(how, s.bodies[i], (value) => { s.bodies[i] = value; view.apply(); });
      at.append(element("label", {}, element("span", { textContent: b.name }), select));
    });
    if (scene.contacts.length) at.append(heading("Contact surfaces"));
    scene.contacts.forEach((c, i) => {
      if (view.flat && c.role !== "contactor") return;
      const label = view.flat ? `${c.contact}: ${c.surface}` : `${c.contact}: ${c.surface} (${c.role})`;
      at.append(tick(label, s.sides[i], (on) => { s.sides[i] = on; view.apply(); }));
    });
    at.append(heading(""), element("button", { textContent: "Save picture", onclick: () => {
      view.draw();
      element("a", { href: view.renderer.domElement.toDataURL("image/png"), download: document.title + ".png" }).click();
    } }));
  }

  // One mode or none, its phase and how far it swings; ``chosen`` is told whether there is one.
  function vibrations(view, at, heading, chosen) {
    const s = view.state, select = element("select", { id: "modes" }), before = s.field;
    const names = ["none: the state itself", ...view.data.modes.map((mode) => mode.name)];
    select.append(...names.map((name, i) => element("option", { textContent: name, value: i - 1 })));
    const go = (k) => { s.phase = k / PHASES; view.apply(); };
    const input = slider(PHASES, 0, (k) => { player.pause(); go(k); });
    const player = playing("play-mode", "play the mode", PHASES, 40, () => Math.round(PHASES * s.phase), (k) => { input.value = k; go(k); });
    const far = slider(SWINGS.length, SWINGS.indexOf(s.swing), (i) => { s.swing = SWINGS[i]; view.apply(); });
    const phase = element("div", { className: "steps", title: "phase" }, player.button, input);
    const more = element("div", { hidden: true }, phase, heading("How far it swings"), far);
    select.onchange = () => {
      s.mode = Number(select.value);
      if (s.mode < 0) player.pause();
      s.field = s.mode < 0 ? before : "mode shape";
      more.hidden = s.mode < 0;
      chosen(s.mode >= 0);
      view.apply();
    };
    at.append(heading("Mode about the end"), select, more);
  }

  function sections(view, at, heading) {
    const s = view.state.section, input = slider(201, Math.round(200 * s.at), (i) => { s.at = i / 200; view.apply(); });
    const side = tick("the other side", s.other, (on) => { s.other = on; view.apply(); });
    const show = () => { input.hidden = side.hidden = !s.axis; };
    at.append(heading("Section"), choice(["none", "x", "y", "z"], s.axis || "none", (axis) => {
      s.axis = axis === "none" ? "" : axis;
      show();
      view.apply();
    }), input, side);
    show();
  }

  function viewButtons(view) {
    const names = view.flat ? ["all"] : ["all", "x", "y", "z", "corner"];
    if (view.pressed) names.splice(1, 0, "contact");
    const buttons = names.map((name) => element("button", { textContent: name, onclick: () => view.look(name) }));
    document.getElementById("views").append(...buttons);
    document.getElementById("hint").textContent = view.flat
      ? "drag to move, wheel to zoom, click for values" : "drag to turn, wheel to zoom, right button to move, click for values";
  }

  function picking(view) {
    const canvas = view.renderer.domElement, box = document.getElementById("picked");
    let start = null;
    canvas.addEventListener("pointerdown", (e) => { start = [e.clientX, e.clientY]; });
    canvas.addEventListener("pointerup", (e) => {
      if (!start || Math.hypot(e.clientX - start[0], e.clientY - start[1]) > 4) return;
      const frame = canvas.getBoundingClientRect();
      const hit = view.pick((e.clientX - frame.left) / frame.width, (e.clientY - frame.top) / frame.height);
      box.hidden = !hit;
      if (!hit) return;
      const words = (name, v) => name === "status" ? STATUS[Math.round(v)][0] : v.toPrecision(6);
      const values = Object.entries(hit.values).map(([name, v]) => `${name}: ${words(name, v)}`);
      box.textContent = [hit.name, `(${hit.point.map(short).join(", ")})`, ...values].join("\n");
    });
  }

  let view = null;
  try {
    view = new View(document.getElementById("canvas"), data.scene);
  } catch (error) {
    if (document.createElement("canvas").getContext("webgl2")) throw error;
    document.getElementById("canvas").textContent = "This browser cannot draw in 3D (WebGL 2 is off); everything below works without.";
    root.dataset.webgl = "off";
  }
  if (view) {
    panel(view);
    viewButtons(view);
    picking(view);
    window.abut = { view };
  }
  drawPlots(data);
  document.getElementById("theme").onclick = () => {
    root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark";
    drawPlots(data);
    if (view) view.apply();
  };
  requestAnimationFrame(() => {
    if (view) {
      const { pixels, colours } = view.count();
      Object.assign(root.dataset, { pixels, colours });
    }
    root.dataset.plots = document.querySelectorAll(".plot canvas").length;
    root.dataset.ready = "true";
  });
})();
