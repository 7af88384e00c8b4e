// SPDX-License-Identifier: Apache-2.0
// Float32 frames and captured vertex stages in WebGL2.

const gl = document.createElement("canvas").getContext("webgl2");
const floats = gl && gl.getExtension("EXT_color_buffer_float");
const filters = gl && gl.getExtension("OES_texture_float_linear");

// The device's name, or a reason why WebGL cannot draw frames.
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

function link(vertex, pixel, outputs = []) {
    const stages = [compile(gl.VERTEX_SHADER, vertex), compile(gl.FRAGMENT_SHADER, pixel)];
    const program = gl.createProgram();
    stages.forEach((stage) => gl.attachShader(program, stage));
    gl.transformFeedbackVaryings(program, outputs, gl.INTERLEAVED_ATTRIBS);
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
        const logs = stages.map((stage) => gl.getShaderInfoLog(stage));
        throw new Error([...logs, gl.getProgramInfoLog(program)].filter(Boolean).join(" | "));
    }
    stages.forEach((stage) => gl.deleteShader(stage));
    return program;
}

// An LRU cache of programs by their texts; one program draws many frames.
const programs = new Map();
const PROGRAMS = 16;

function programOf(vertex, pixel) {
    const key = vertex + pixel;
    const program = programs.get(key) || link(vertex, pixel);
    programs.delete(key);
    programs.set(key, program);
    const [oldest] = programs.keys();
    if (programs.size > PROGRAMS) {
        gl.deleteProgram(programs.get(oldest));
        programs.delete(oldest);
    }
    return program;
}

// An array in a job's file.
function view({ shape, offset }, data, Kind = Float32Array) {
    return new Kind(data, offset, shape.reduce((product, each) => product * each));
}

// A repeating float32 texture without mipmaps. Arrays of four dimensions become array textures.
function upload(layout, data) {
    const texture = gl.createTexture();
    if (layout.shape.length == 4) {
        const [depth, height, width] = layout.shape;
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
        const size = [width, height, depth];
        gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA32F, ...size);
        const place = [gl.TEXTURE_2D_ARRAY, 0, 0, 0, 0, ...size];
        gl.texSubImage3D(...place, gl.RGBA, gl.FLOAT, view(layout, data));
        return texture;
    }
    const [height, width, components] = layout.shape;
    const [inner, outer] = [
        [gl.R32F, gl.RED],
        [gl.RG32F, gl.RG],
        [gl.RGB32F, gl.RGB],
        [gl.RGBA32F, gl.RGBA],
    ][components - 1];
    gl.bindTexture(gl.TEXTURE_2D, texture);
    const texels = view(layout, data);
    gl.texImage2D(gl.TEXTURE_2D, 0, inner, width, height, 0, outer, gl.FLOAT, texels);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    return texture;
}

// Functions that set a uniform, by the uniform's type.
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

// Sets vertex attributes and returns their new buffers.
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

// Calls `draw` with its own vertex array.
function withAttributes(program, attributes, data, draw) {
    const state = gl.createVertexArray();
    gl.bindVertexArray(state);
    const buffers = setAttributes(program, attributes, data);
    draw();
    gl.deleteVertexArray(state);
    buffers.forEach((each) => gl.deleteBuffer(each));
}

// A frame as RGBA float32, row 0 at the bottom.
function render(program, job, data) {
    const { size, uniforms, textures, attributes } = job;
    const target = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, target);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, ...size);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target);
    gl.viewport(0, 0, ...size);
    gl.useProgram(program);
    setUniforms(program, uniforms);
    const used = Object.entries(textures).filter(([name]) => gl.getUniformLocation(program, name));
    const bound = used.map(([name, layout], unit) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.uniform1i(gl.getUniformLocation(program, name), unit);
        const texture = upload(layout, data);
        if (name == "u_albedoTable") {
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
        }
        if (["u_envRadiance", "u_envIrradiance"].includes(name) && layout.shape[0] > 2) {
            // Maps are clamped at the poles, except uniform maps, so that checks detect NaN.
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
        }
        return texture;
    });
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    withAttributes(program, attributes, data, () => gl.drawArrays(gl.TRIANGLES, 0, 3));
    const pixels = new Float32Array(4 * size[0] * size[1]);
    gl.readPixels(0, 0, ...size, gl.RGBA, gl.FLOAT, pixels);
    bound.forEach((texture) => gl.deleteTexture(texture));
    gl.deleteFramebuffer(frame); // so nothing draws into a deleted frame
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

// Outputs of a vertex stage for `count` points in sequence, `stride` bytes per point.
function feedback(program, { attributes, uniforms, count, stride }, data) {
    const captured = new Uint8Array(count * stride);
    const buffer = gl.createBuffer();
    gl.useProgram(program);
    setUniforms(program, uniforms);
    withAttributes(program, attributes, data, () => {
        gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
        gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, captured.length, gl.STREAM_READ);
        gl.enable(gl.RASTERIZER_DISCARD);
        gl.beginTransformFeedback(gl.POINTS);
        gl.drawArrays(gl.POINTS, 0, count);
        gl.endTransformFeedback();
        gl.disable(gl.RASTERIZER_DISCARD);
        gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, captured);
        gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
    });
    gl.deleteBuffer(buffer);
    return captured;
}

// Returns { bytes } from `work`, { refused } with the compiler's message, or { failed }.
async function answer(makeProgram, work, job) {
    const data = await document.querySelector("input").files[0].arrayBuffer();
    let program;
    try {
        program = makeProgram();
    } catch (error) {
        return { refused: error.message };
    }
    const bytes = work(program, job, data);
    const code = gl.getError();
    if (code) return { failed: `WebGL error 0x${code.toString(16)}` };
    return { bytes: await encode(bytes) };
}

function draw(job) {
    return answer(() => programOf(job.vertex, job.pixel), render, job);
}

const EMPTY = "#version 300 es\nvoid main() {}\n";

function capture(job) {
    return answer(() => link(job.vertex, EMPTY, job.outputs), feedback, job);
}
