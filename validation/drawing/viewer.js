// Draws a scene with WebGL. Dragging turns it, wheel or pinch zooms, dragging with Shift moves it.
const showScene = (() => {
  const PERIOD = 1600;  // period of the animation of displacements (ms)
  const HALF_ANGLE = Math.PI / 12;  // half the angle of the field of view
  const decoded = text => Uint8Array.from(atob(text.trim()), letter => letter.charCodeAt(0));
  const element = (name, properties) => Object.assign(document.createElement(name), properties);

  const CAMERA = `#version 300 es
    uniform mat3 turn; uniform vec3 centre; uniform vec4 lens; uniform vec2 size; uniform float part;
    vec3 seen(vec3 place, vec3 away) {
      return turn * (place + (part - 1.0) * away - centre) - vec3(0.0, 0.0, lens.y);
    }
    vec4 projected(vec3 eye) {
      float near = 0.02 * lens.y, far = 4.0 * lens.y + lens.z;
      return vec4(lens.x * eye.x * size.y / size.x, lens.x * eye.y,
        -(far + near) / (far - near) * eye.z - 2.0 * far * near / (far - near), -eye.z);
    }`;
  const FACES = [CAMERA + `
    in vec3 place, away, colour; out vec3 eye, tint;
    void main() { eye = seen(place, away); tint = colour; gl_Position = projected(eye); }`,
  `#version 300 es
    precision highp float; in vec3 eye, tint; out vec4 drawn;
    void main() {
      vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
      drawn = vec4(tint * (0.4 + 0.6 * abs(normal.z)), 1.0);
    }`];
  // Lines are drawn as strips with four corners, because lines of WebGL are one pixel wide.
  const LINES = [CAMERA + `
    in vec3 place, away, next, nextAway; uniform float width;
    void main() {
      vec4 ends[2] = vec4[](projected(seen(place, away)), projected(seen(next, nextAway)));
      vec2 along = (ends[1].xy / ends[1].w - ends[0].xy / ends[0].w) * size;
      vec2 across = normalize(vec2(-along.y, along.x) + 1e-9);
      vec4 end = ends[gl_VertexID >> 1];
      end.xy += across * float(2 * (gl_VertexID & 1) - 1) * width / size * end.w;
      end.z -= 5e-4 * end.w;
      gl_Position = end;
    }`,
  `#version 300 es
    precision highp float; uniform vec3 tint; out vec4 drawn;
    void main() { drawn = vec4(tint, 1.0); }`];

  const program = (gl, texts) => {
    const made = gl.createProgram();
    [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((kind, place) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, texts[place]);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    });
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw Error(gl.getProgramInfoLog(made));
    return made;
  };

  const attribute = (gl, made, name, values, each) => {
    const place = gl.getAttribLocation(made, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, values instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.FLOAT,
      values instanceof Uint8Array, 0, 0);
    gl.vertexAttribDivisor(place, each);
  };

  // Copies a body or line to buffers. Returns the function that draws it.
  const loaded = (gl, faces, lines, numbers, part) => {
    const lengths = ({ step, values }) => Float32Array.from(numbers(Int16Array, values), n => n * step);
    const points = lengths(part.points);
    const away = part.motion ? lengths(part.motion) : new Float32Array(points.length);
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    if (part.faces) {
      const corners = numbers(Uint32Array, part.faces);
      const triangles = new Uint32Array(corners.length / 4 * 6);
      for (let k = 0; k < corners.length / 4; k++)
        triangles.set([0, 1, 2, 0, 2, 3].map(corner => corners[4 * k + corner]), 6 * k);
      attribute(gl, faces, "place", points, 0);
      attribute(gl, faces, "away", away, 0);
      const plain = Uint8Array.from(points, (_, k) => part.colour[k % 3]);
      attribute(gl, faces, "colour", part.colours ? numbers(Uint8Array, part.colours) : plain, 0);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
      return { made: faces, draw: () => {
        gl.bindVertexArray(array);
        gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_INT, 0);
      } };
    }
    const pairs = numbers(Uint32Array, part.pairs);
    const ends = (values, first) => Float32Array.from(
      { length: 1.5 * pairs.length },
      (_, k) => values[3 * pairs[2 * Math.floor(k / 3) + first] + k % 3]);
    [["place", points, 0], ["away", away, 0], ["next", points, 1], ["nextAway", away, 1]].forEach(
      ([name, values, first]) => attribute(gl, lines, name, ends(values, first), 1));
    return { made: lines, draw: () => {
      gl.bindVertexArray(array);
      gl.uniform1f(gl.getUniformLocation(lines, "width"), part.width * devicePixelRatio);
      gl.uniform3fv(gl.getUniformLocation(lines, "tint"), part.colour.map(c => c / 255));
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, pairs.length / 2);
    } };
  };

  const turned = (vectors, axis, angle) => vectors.map(([x, y, z]) => {
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    const [u, v, w] = axis, along = (1 - c) * (u * x + v * y + w * z);
    return [along * u + c * x + s * (v * z - w * y), along * v + c * y + s * (w * x - u * z),
      along * w + c * z + s * (u * y - v * x)];
  });

  // Header of an encoded scene, and the function that returns the numbers to which it refers.
  const unpacked = async (packed) => {
    const stream = new Blob([decoded(packed)]).stream();
    const whole = new Response(stream.pipeThrough(new DecompressionStream("gzip")));
    const content = await whole.arrayBuffer();
    const length = new DataView(content).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(content, 4, length)));
    return [header, (kind, [place, count]) => new kind(content, 4 + length + place, count)];
  };

  // Shows an encoded scene in the element `place`. The wheel scrolls the page until it is clicked.
  return async (place, packed) => {
    const [state, numbers] = await unpacked(packed);
    const canvas = element("canvas", { title: state.title + ", drag to turn" });
    const veil = element("button", {
      type: "button", className: "veil", textContent: "click to turn and zoom" });
    veil.addEventListener("click", () => { veil.hidden = true; });
    place.onpointerleave = () => { veil.hidden = false; };
    place.replaceChildren(canvas, veil);
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) { veil.textContent = "this browser has no WebGL"; return; }
    const [faces, lines] = [program(gl, FACES), program(gl, LINES)];
    const parts = state.parts.map(part => loaded(gl, faces, lines, numbers, part));
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(1, 1, 1, 1);
    let { axes, centre, half } = state.camera, part = 1;
    // Perspective enlarges near bodies: the camera is a little farther away, so that none is cut off.
    const full = 1.2 * half / Math.tan(HALF_ANGLE);
    let distance = full;

    const draw = () => {
      const size = [canvas.clientWidth, canvas.clientHeight].map(
        length => Math.max(1, Math.round(length * devicePixelRatio)));
      if (canvas.width !== size[0] || canvas.height !== size[1])
        [canvas.width, canvas.height] = size;
      gl.viewport(0, 0, ...size);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const columns = [0, 1, 2].flatMap(k => axes.map(axis => axis[k]));
      for (const { made, draw: drawPart } of parts) {
        const uniform = name => gl.getUniformLocation(made, name);
        gl.useProgram(made);
        gl.uniformMatrix3fv(uniform("turn"), false, columns);
        gl.uniform3fv(uniform("centre"), centre);
        gl.uniform4f(uniform("lens"), 1 / Math.tan(HALF_ANGLE), distance, full, 0);
        gl.uniform2f(uniform("size"), ...size);
        gl.uniform1f(uniform("part"), part);
        drawPart();
      }
    };

    const pointers = new Map();
    const gap = () => {
      const [a, b] = [...pointers.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    const zoom = (factor) => { distance = Math.min(Math.max(distance * factor, 0.05 * full), 5 * full); };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    ["pointerup", "pointercancel"].forEach(name => canvas.addEventListener(
      name, event => pointers.delete(event.pointerId)));
    canvas.addEventListener("pointermove", (event) => {
      const former = pointers.get(event.pointerId);
      if (!former) return;
      const [x, y] = [event.clientX - former.x, event.clientY - former.y];
      const before = pointers.size === 2 ? gap() : 0;
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      const scale = 2 * distance * Math.tan(HALF_ANGLE) / canvas.clientHeight;
      if (before) zoom(before / Math.max(gap(), 1));
      else if (event.shiftKey)
        centre = centre.map((c, k) => c + scale * (y * axes[1][k] - x * axes[0][k]));
      else {
        axes = turned(axes, axes[1], -0.01 * x);
        axes = turned(axes, axes[0], -0.01 * y);
      }
      draw();
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      zoom(Math.exp(0.0015 * event.deltaY));
      draw();
    }, { passive: false });
    new ResizeObserver(draw).observe(canvas);
    if (!state.parts.some(one => one.motion)) return;

    // A mode swings to both sides of the position at rest. A load pushes to one side and releases.
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const pause = element("button", {
      type: "button", className: "pause", textContent: "stand still", ariaPressed: String(still) });
    pause.addEventListener("click", () => {
      pause.ariaPressed = String(pause.ariaPressed !== "true");
    });
    place.append(pause);
    let reached = 0, former = null;
    const step = (now) => {
      if (!canvas.isConnected) return;
      requestAnimationFrame(step);
      const { top, bottom } = canvas.getBoundingClientRect();
      const shown = bottom > 0 && top < innerHeight && pause.ariaPressed !== "true";
      reached += shown && former !== null ? now - former : 0;
      former = now;
      if (!shown) return;
      const swing = Math.cos(2 * Math.PI * reached / PERIOD);
      part = state.motion === "swing" ? swing : (1 + swing) / 2;
      draw();
    };
    requestAnimationFrame(step);
  };
})();
