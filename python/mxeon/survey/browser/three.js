// SPDX-License-Identifier: Apache-2.0
// Pictures of the sphere by three.js: WebGLRenderer, WebGPURenderer and MaterialXLoader.

import * as GL from "three";
import * as GPU from "three/webgpu";
import { MaterialXLoader } from "three/addons/loaders/MaterialXLoader.js";
import { encode, sphere } from "/sphere.js";

const renderers = {};

async function start(backend) {
    if (renderers[backend]) return renderers[backend];
    const options = { antialias: false };
    if (backend === "webgl") {
        const renderer = new GL.WebGLRenderer(options);
        const context = renderer.getContext();
        const info = context.getExtension("WEBGL_debug_renderer_info");
        const device = context.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER);
        return (renderers[backend] = { renderer, device, three: GL });
    }
    const renderer = new GPU.WebGPURenderer(options);
    await renderer.init();
    if (!renderer.backend.isWebGPUBackend) throw new Error("the browser has no WebGPU adapter");
    const { vendor, architecture } = renderer.backend.device.adapterInfo;
    return (renderers[backend] = { renderer, device: `${vendor} ${architecture}`, three: GPU });
}

const geometries = new Map(); // keys: library and size

function geometryOf(three, size) {
    const key = `${three === GL} ${size}`;
    if (!geometries.has(key)) {
        const { positions, normals, tangents, indices } = sphere(size);
        const geometry = new three.BufferGeometry();
        geometry.setAttribute("position", new three.BufferAttribute(positions, 3));
        geometry.setAttribute("normal", new three.BufferAttribute(normals, 3));
        geometry.setAttribute("tangent", new three.BufferAttribute(tangents, 4));
        geometry.setIndex(new three.BufferAttribute(indices, 1));
        geometries.set(key, geometry);
    }
    return geometries.get(key);
}

function physicalMaterial(three, { color, roughness }) {
    const material = new three.MeshPhysicalMaterial({ specularIntensity: 0, metalness: 0, roughness: 1 });
    material.color.setRGB(...color); // in the linear working space
    material.diffuseRoughness = roughness;
    return material;
}

function loadedMaterial({ document: text, element }) {
    let materials, log;
    try {
        ({ materials, log } = new MaterialXLoader().parse(text));
    } catch ({ message }) {
        throw new Error(message.replace(/^.*error\(s\)\. /, "MaterialXLoader: "));
    }
    const errors = log.filter(({ severity }) => severity === "error");
    if (errors.length) throw new Error(`MaterialXLoader: ${errors[0].code}: ${errors[0].message}`);
    const material = materials[element] ?? Object.values(materials)[0];
    const ignored = log.map(({ message }) => message.match(/input "(\w+)" is/)?.[1] ?? message);
    return { material, ignored };
}

const maps = new Map(); // cached by library, since filtering takes seconds on a software driver

// An environment map of radiance 1.
function surroundings(three) {
    if (maps.has(three)) return maps.get(three);
    const texels = new Float32Array(8 * 4 * 4).fill(1);
    const map = new three.DataTexture(texels, 8, 4, three.RGBAFormat, three.FloatType);
    map.mapping = three.EquirectangularReflectionMapping;
    map.colorSpace = three.LinearSRGBColorSpace;
    map.needsUpdate = true;
    maps.set(three, map);
    return map;
}

function stage(three, job) {
    const scene = new three.Scene();
    if (job.light) {
        const light = new three.DirectionalLight(0xffffff, job.irradiance);
        light.position.set(...job.light);
        scene.add(light);
    }
    if (job.environment) scene.environment = surroundings(three);
    scene.environmentIntensity = job.environment ?? 0;
    if (job.ambient) scene.add(new three.AmbientLight(0xffffff, Math.PI * job.ambient));
    return scene;
}

export async function draw(job) {
    const { renderer, device, three } = await start(job.backend);
    if (!job.size && !job.document) return { device, revision: three.REVISION };
    const { material, ignored } = job.document
        ? loadedMaterial(job)
        : { material: physicalMaterial(three, job) };
    if (!job.size) return { device, ignored };
    const scene = stage(three, job);
    const mesh = new three.Mesh(geometryOf(three, job.size), material);
    mesh.frustumCulled = false;
    scene.add(mesh);
    const camera = new three.OrthographicCamera(-1, 1, 1, -1, 0.1, 10);
    camera.position.z = 2;
    const options = { type: three.FloatType, depthBuffer: true, generateMipmaps: false };
    const pixels = await frame(job, renderer, three, scene, camera, options);
    material.dispose();
    return { device, pixels };
}

async function frame({ backend, size }, renderer, three, scene, camera, options) {
    const gl = backend === "webgl";
    const target = gl
        ? new three.WebGLRenderTarget(size, size, options)
        : new three.RenderTarget(size, size, options);
    renderer.setRenderTarget(target);
    let pixels = new Float32Array(4 * size * size);
    if (gl) {
        renderer.render(scene, camera);
        renderer.readRenderTargetPixels(target, 0, 0, size, size, pixels);
    } else {
        await renderer.renderAsync(scene, camera);
        pixels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, size, size);
    }
    renderer.setRenderTarget(null);
    target.dispose();
    return encode(pixels, size, gl);
}
