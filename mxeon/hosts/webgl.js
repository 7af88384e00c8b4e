// SPDX-License-Identifier: Apache-2.0
// One triangle over a float32 frame in WebGL2, its texture coordinates being the pixels themselves.

const gl = document.createElement("canvas").getContext("webgl2");
const floats = gl && gl.getExtension("EXT_color_buffer_float");

// The device, or why there can be no frame.
function identify() {
    if (!floats) return { failed: "the browser has no WebGL2 with float32 frames" };
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

// A texture of unfiltered float32 texels, for texelFetch and for look-ups of a single texel alike.
function upload({ width, height, components, offset }, data) {
    const [inner, outer] = { 1: [gl.R32F, gl.RED], 3: [gl.RGB32F, gl.RGB] }[components];
    const texels = new Float32Array(data, offset, width * height * components);
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, inner, width, height, 0, outer, gl.FLOAT, texels);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return texture;
}

function setUniforms(program, values) {
    for (const [name, value] of Object.entries(values)) {
        const place = gl.getUniformLocation(program, name);
        if (value.length) gl.uniformMatrix4fv(place, false, value);
        else gl.uniform1f(place, value);
    }
}

function setAttributes(program, attributes) {
    for (const [name, values] of Object.entries(attributes)) {
        const place = gl.getAttribLocation(program, name);
        if (place < 0) continue;
        gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values.flat()), gl.STATIC_DRAW);
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    }
}

// A frame as RGBA float32, row 0 at the bottom.
function render(program, { size, attributes, uniforms, textures }, data) {
    const target = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, target);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, ...size);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target);
    gl.viewport(0, 0, ...size);
    gl.useProgram(program);
    setUniforms(program, uniforms);
    setAttributes(program, attributes);
    const used = Object.entries(textures).filter(([name]) => gl.getUniformLocation(program, name));
    const bound = used.map(([name, layout], unit) => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.uniform1i(gl.getUniformLocation(program, name), unit);
        return upload(layout, data);
    });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
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
