// SPDX-License-Identifier: Apache-2.0
// Pictures of the sphere by Babylon.js: PBRMaterial and OpenPBRMaterial in WebGL2 and WebGPU.

import { Engine } from "@babylonjs/core/Engines/engine.js";
import { WebGPUEngine } from "@babylonjs/core/Engines/webgpuEngine.js";
import { Constants } from "@babylonjs/core/Engines/constants.js";
import { Scene } from "@babylonjs/core/scene.js";
import { Color3, Color4 } from "@babylonjs/core/Maths/math.color.js";
import { Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { Camera } from "@babylonjs/core/Cameras/camera.js";
import { FreeCamera } from "@babylonjs/core/Cameras/freeCamera.js";
import { DirectionalLight } from "@babylonjs/core/Lights/directionalLight.js";
import { Mesh } from "@babylonjs/core/Meshes/mesh.js";
import { VertexData } from "@babylonjs/core/Meshes/mesh.vertexData.js";
import { PBRMaterial } from "@babylonjs/core/Materials/PBR/pbrMaterial.js";
import { OpenPBRMaterial } from "@babylonjs/core/Materials/PBR/openpbrMaterial.js";
import { RawCubeTexture } from "@babylonjs/core/Materials/Textures/rawCubeTexture.js";
import { RenderTargetTexture } from "@babylonjs/core/Materials/Textures/renderTargetTexture.js";
import { CubeMapToSphericalPolynomialTools } from "@babylonjs/core/Misc/HighDynamicRange/cubemapToSphericalPolynomial.js";
import "@babylonjs/core/Engines/Extensions/engine.rawTexture.js";
import "@babylonjs/core/Engines/Extensions/engine.renderTarget.js";
import "@babylonjs/core/Engines/Extensions/engine.renderTargetTexture.js";
import "@babylonjs/core/Engines/Extensions/engine.readTexture.js";
import "@babylonjs/core/Engines/WebGPU/Extensions/engine.rawTexture.js";
import "@babylonjs/core/Engines/WebGPU/Extensions/engine.renderTarget.js";
import "@babylonjs/core/Engines/WebGPU/Extensions/engine.renderTargetTexture.js";
import "@babylonjs/core/Engines/WebGPU/Extensions/engine.readTexture.js";
import "@babylonjs/core/Materials/Textures/baseTexture.polynomial.js";
import { encode, sphere } from "/sphere.js";

// Distance of the camera. Babylon.js computes view directions from the position of the camera, even
// for an orthographic projection.
const FAR = 1e7;

const stages = {};

// A canvas whose WebGPU context is a texture, because Chromium's software adapter shows no canvas.
function hiddenCanvas() {
    const canvas = document.createElement("canvas");
    let texture;
    const context = {
        canvas,
        configure({ device, format }) {
            const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC;
            texture = device.createTexture({ size: [canvas.width, canvas.height], format, usage });
        },
        unconfigure() {},
        getCurrentTexture: () => texture,
    };
    canvas.getContext = () => context;
    return canvas;
}

async function engineOf(backend) {
    if (backend === "webgl") {
        const engine = new Engine(document.createElement("canvas"), false);
        return { engine, device: engine.getGlInfo().renderer };
    }
    const engine = new WebGPUEngine(hiddenCanvas(), { antialias: false });
    await engine.initAsync();
    return { engine, device: engine.getInfo().renderer };
}

async function start(backend) {
    if (stages[backend]) return stages[backend];
    const { engine, device } = await engineOf(backend);
    const scene = new Scene(engine);
    scene.useRightHandedSystem = true;
    scene.clearColor = new Color4(0, 0, 0, 0);
    scene.imageProcessingConfiguration.applyByPostProcess = true; // leaves colors linear
    scene.imageProcessingConfiguration.skipFinalColorClamp = true;
    const camera = new FreeCamera("camera", new Vector3(0, 0, FAR), scene);
    camera.setTarget(Vector3.Zero());
    camera.mode = Camera.ORTHOGRAPHIC_CAMERA;
    [camera.orthoLeft, camera.orthoRight, camera.orthoBottom, camera.orthoTop] = [-1, 1, -1, 1];
    [camera.minZ, camera.maxZ] = [0.5 * FAR, 1.5 * FAR];
    const light = new DirectionalLight("light", new Vector3(0, 0, -1), scene);
    return (stages[backend] = { engine, device, scene, camera, light, meshes: new Map() });
}

function meshOf({ scene, meshes }, size) {
    if (!meshes.has(size)) {
        const mesh = new Mesh(`sphere ${size}`, scene);
        Object.assign(new VertexData(), sphere(size)).applyToMesh(mesh);
        mesh.alwaysSelectAsActiveMesh = true;
        meshes.set(size, mesh);
    }
    return meshes.get(size);
}

function pbrMaterial(scene, { color, roughness, model }) {
    const material = new PBRMaterial("material", scene);
    material.albedoColor = new Color3(...color);
    material.metallic = 0;
    material.roughness = model === "LEGACY" ? roughness : 1; // LEGACY ignores baseDiffuseRoughness
    material.metallicF0Factor = 0; // no specular lobe
    material.baseDiffuseRoughness = roughness;
    material.brdf.baseDiffuseModel = Constants[`MATERIAL_DIFFUSE_MODEL_${model}`];
    return material;
}

function openPbrMaterial(scene, { color, roughness }) {
    const material = new OpenPBRMaterial("material", scene);
    material.baseColor = new Color3(...color);
    material.baseDiffuseRoughness = roughness;
    material.specularWeight = 0;
    return material;
}

// An OpenPBRMaterial with values of open_pbr_surface, and the names of inputs that the class lacks.
function readMaterial(scene, inputs) {
    const material = new OpenPBRMaterial("material", scene), ignored = [];
    for (const [name, value] of Object.entries(inputs)) {
        if (name in material) material[name] = value.length ? new Color3(...value) : Number(value);
        else ignored.push(name);
    }
    return { material, ignored };
}

// An environment map of radiance 1, with the spherical polynomial that Babylon.js computes.
async function surroundings(stage) {
    if (!stage.map) {
        const size = 16;
        const faces = [...Array(6)].map(() => new Float32Array(4 * size * size).fill(1));
        const map = new RawCubeTexture(
            stage.scene, faces, size, Constants.TEXTUREFORMAT_RGBA, Constants.TEXTURETYPE_FLOAT,
        );
        map.gammaSpace = false;
        map.sphericalPolynomial =
            await CubeMapToSphericalPolynomialTools.ConvertCubeMapTextureToSphericalPolynomial(map);
        stage.map = map;
    }
    return stage.map;
}

export async function draw(job) {
    const stage = await start(job.backend);
    const { device, scene, light } = stage;
    const read = job.inputs && readMaterial(scene, job.inputs);
    if (!job.size) return { device, ignored: read?.ignored };
    light.setEnabled(Boolean(job.light));
    if (job.light) {
        light.direction = new Vector3(...job.light).scale(-1);
        light.intensity = job.irradiance;
    }
    scene.environmentTexture = job.environment ? await surroundings(stage) : null;
    scene.environmentIntensity = job.environment ?? 0;
    const mesh = meshOf(stage, job.size);
    mesh.material = read ? read.material : job.model ? pbrMaterial(scene, job) : openPbrMaterial(scene, job);
    mesh.material.backFaceCulling = false;
    if (job.filtering) mesh.material.realTimeFiltering = true;
    const pixels = await frame(stage, mesh, job.size);
    mesh.material.dispose();
    return { device, pixels };
}

async function frame({ scene, camera }, mesh, size) {
    const target = new RenderTargetTexture("target", size, scene, {
        type: Constants.TEXTURETYPE_FLOAT,
        format: Constants.TEXTUREFORMAT_RGBA,
        samplingMode: Constants.TEXTURE_NEAREST_SAMPLINGMODE,
        generateMipMaps: false,
    });
    target.activeCamera = camera;
    target.renderList = [mesh];
    target.clearColor = new Color4(0, 0, 0, 0);
    while (!target.isReadyForRendering()) await new Promise((resolve) => setTimeout(resolve, 5));
    target.render();
    const pixels = await target.readPixels();
    target.dispose();
    return encode(pixels, size, true);
}
