// SPDX-License-Identifier: Apache-2.0
// Functions of three-gpu-pathtracer's WGSL, executed by a compute shader for rows of numbers.

import * as eon from "three-gpu-pathtracer/src/webgpu/nodes/eon.wgsl.js";
import { encode } from "/sphere.js";

// The members of the package's struct that the called functions read.
const SURFACE = "struct SurfaceRecord { color: vec3f, diffuseRoughness: f32 }";

// Number of columns: wo (3), wi or random numbers (3), color (3), roughness (1).
const COLUMNS = 10;
const BRDF = (name) => `
    var surface: SurfaceRecord;
    surface.color = color;
    surface.diffuseRoughness = roughness;
    let cosine = sqrt(saturate(0.5 * (1.0 + dot(wo, wi))));
    var value = vec3f(0.0);
    if (wi.z > 0.0) { value = ${name}(wo.z, wi.z, cosine, surface) * wi.z; }`;
const CALLS = {
    eon: [eon.eonBrdfFunc, BRDF("eonBrdf")],
    fon: [eon.fonBrdfFunc, BRDF("fonBrdf")],
    density: [eon.eonPDFFunc, "let value = vec3f(eonPdf(wo, wi, roughness));"],
    sample: [eon.eonDirectionFunc, "let value = eonDirection(wo, roughness, wi.xy);"],
};

let device = null;

async function start() {
    if (device) return;
    const adapter = await navigator.gpu?.requestAdapter();
    if (!adapter) throw new Error("the browser has no WebGPU adapter");
    device = await adapter.requestDevice();
}

// The text of a function and its includes, without repetition.
function textOf(node, seen = new Set()) {
    const included = node.functionNode ?? node;
    if (seen.has(included)) return "";
    seen.add(included);
    const parts = (included.includes ?? []).map((each) => textOf(each, seen));
    return [...parts, included.code ?? ""].join("\n");
}

function shader(call) {
    const [node, body] = CALLS[call];
    return `${SURFACE}
${textOf(node)}
@group(0) @binding(0) var<storage, read> rows: array<f32>;
@group(0) @binding(1) var<storage, read_write> results: array<vec4f>;
fn triple(index: u32) -> vec3f { return vec3f(rows[index], rows[index + 1], rows[index + 2]); }
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= arrayLength(&results)) { return; }
    let start = ${COLUMNS} * row;
    let wo = triple(start);
    let wi = triple(start + 3);
    let color = triple(start + 6);
    let roughness = rows[start + 9];
    ${body}
    results[row] = vec4f(value, 0.0);
}`;
}

async function execute({ call, rows }) {
    const code = shader(call);
    const module = device.createShaderModule({ code });
    const { messages } = await module.getCompilationInfo();
    const error = messages.find(({ type }) => type === "error");
    if (error) throw new Error(`the shader does not compile: ${error.message}`);
    const bytes = Uint8Array.from(atob(rows), (each) => each.charCodeAt(0));
    const count = bytes.length / 4 / COLUMNS;
    const { STORAGE, COPY_DST, COPY_SRC, MAP_READ } = GPUBufferUsage;
    const source = device.createBuffer({ size: bytes.length, usage: STORAGE | COPY_DST });
    const target = device.createBuffer({ size: 16 * count, usage: STORAGE | COPY_SRC });
    const copy = device.createBuffer({ size: 16 * count, usage: MAP_READ | COPY_DST });
    device.queue.writeBuffer(source, 0, bytes);
    const pipeline = device.createComputePipeline({ layout: "auto", compute: { module, entryPoint: "main" } });
    const entries = [source, target].map((buffer, binding) => ({ binding, resource: { buffer } }));
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
    pass.dispatchWorkgroups(Math.ceil(count / 64));
    pass.end();
    encoder.copyBufferToBuffer(target, 0, copy, 0, 16 * count);
    device.queue.submit([encoder.finish()]);
    await copy.mapAsync(GPUMapMode.READ);
    const values = new Float32Array(copy.getMappedRange().slice(0));
    for (const buffer of [source, target, copy]) buffer.destroy();
    return values;
}

export async function draw(job) {
    await start();
    const { vendor, architecture } = device.adapterInfo;
    if (!job.call) return { device: `${vendor} ${architecture}` };
    const values = await execute(job);
    return { pixels: encode(values, Math.sqrt(values.length / 4), false) };
}
