// SPDX-License-Identifier: Apache-2.0
// A mesh over a float32 frame in WebGL2.

const gl = document.createElement("canvas").getContext("webgl2");
const floats = gl && gl.getExtension("EXT_color_buffer_float");
const filters = gl && gl.getExtension("OES_texture_float_linear");

// The device, or why there can be no frame.
function identify() {
    if (!floats || !filters) {
        return { failed: "the browser has no WebGL2 with float32 frames and filtered float32 textures" };
    }
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    return { device: gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER) };
}

function compile(kind, text) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    return shader;
}

function link(vertex, pixel) {
    const stages = [compile(gl.VERTEX_SHADER, vertex), compile(gl.FRAGMENT_SHADER, pixel)];
    const program = gl.createProgram();
    stages.forEach((stage) => gl.attachShader(program, stage));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
        const logs = stages.map((stage) => gl.getShaderInfoLog(stage));
        throw new Error([...logs, gl.getProgramInfoLog(program)].filter(Boolean).join(" | "));
    }
    stages.forEach((stage) => gl.deleteShader(stage));
    return program;
}

// An array of a job's file.
function view({ shape, offset }, data, Kind = Float32Array) {
    return new Kind(data, offset, shape.reduce((product, each) => product * each));
}

// A texture of float32 texels that repeats, without smaller versions of itself.
function upload(layout, data) {
    const [height, width, components] = layout.shape;
    const [inner, outer] = [
        [gl.R32F, gl.RED],
        [gl.RG32F, gl.RG],
        [gl.RGB32F, gl.RGB],
        [gl.RGBA32F, gl.RGBA],
    ][components - 1];
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    const texels = view(layout, data);
    gl.texImage2D(gl.TEXTURE_2D, 0, inner, width, height, 0, outer, gl.FLOAT, texels);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    return texture;
}

// What sets a uniform, by its type.
function setters() {
    return {
        [gl.FLOAT]: (place, value) => gl.uniform1f(place, value),
        [gl.INT]: (place, value) => gl.uniform1i(place, value),
        [gl.BOOL]: (place, value) => gl.uniform1i(place, value),
        [gl.FLOAT_VEC2]: (place, value) => gl.uniform2fv(place, value),
        [gl.FLOAT_VEC3]: (place, value) => gl.uniform3fv(place, value),
        [gl.FLOAT_VEC4]: (place, value) => gl.uniform4fv(place, value),
        [gl.FLOAT_MAT3]: (place, value) => gl.uniformMatrix3fv(place, false, value),
        [gl.FLOAT_MAT4]: (place, value) => gl.uniformMatrix4fv(place, false, value),
    };
}

function setUniforms(program, values) {
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let index = 0; index < count; ++index) {
        const { name, type } = gl.getActiveUniform(program, index);
        if (name in values) setters()[type](gl.getUniformLocation(program, name), values[name]);
    }
}

// The buffers that were made.
function setAttributes(program, attributes, data) {
    return Object.entries(attributes).map(([name, layout]) => {
        const place = gl.getAttribLocation(program, name);
        const buffer = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.bufferData(gl.ARRAY_BUFFER, view(layout, data), gl.STATIC_DRAW);
        if (place >= 0) {
            gl.enableVertexAttribArray(place);
            gl.vertexAttribPointer(place, layout.shape[1], gl.FLOAT, false, 0, 0);
        }
        return buffer;
    });
}

// Draws the triangles, with vertex arrays that are theirs alone.
function drawMesh(program, { attributes, mesh }, data) {
    const state = gl.createVertexArray();
    gl.bindVertexArray(state);
    const buffers = setAttributes(program, attributes, data);
    const order = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, order);
    const indices = view(mesh.indices, data, Uint32Array);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
    gl.drawElements(gl.TRIANGLES, indices.length, gl.UNSIGNED_INT, 0);
    gl.deleteVertexArray(state);
    [...buffers, order].forEach((each) => gl.deleteBuffer(each));
}

// A frame as RGBA float32, row 0 at the bottom.
function render(program, job, data) {
    const { size, uniforms, textures } = job;
    const target = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, target);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, ...size);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target);
    gl.viewport(0, 0, ...size);
    gl.useProgram(program);
    setUniforms(program, uniforms);
    const used = Object.entries(textures).filter(([name]) => gl.getUniformLocation(program, name));
    const bound = used.map(([name, layout], unit) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.uniform1i(gl.getUniformLocation(program, name), unit);
        return upload(layout, data);
    });
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    drawMesh(program, job, data);
    const pixels = new Float32Array(4 * size[0] * size[1]);
    gl.readPixels(0, 0, ...size, gl.RGBA, gl.FLOAT, pixels);
    bound.forEach((texture) => gl.deleteTexture(texture));
    gl.deleteRenderbuffer(target);
    return pixels;
}

// Base64 text of an array's bytes.
function encode(array) {
    return new Promise((resolve) => {
        const reader = new FileReader();
        reader.onload = () => resolve(reader.result.split(",")[1]);
        reader.readAsDataURL(new Blob([array]));
    });
}

// What a job asks for: { pixels }, or { refused } in the compiler's words, or { failed }.
async function draw(job) {
    const data = await document.querySelector("input").files[0].arrayBuffer();
    let program;
    try {
        program = link(job.vertex, job.pixel);
    } catch (error) {
        return { refused: error.message };
    }
    const pixels = render(program, job, data);
    gl.deleteProgram(program);
    const code = gl.getError();
    if (code) return { failed: `WebGL error 0x${code.toString(16)}` };
    return { pixels: await encode(pixels) };
}
