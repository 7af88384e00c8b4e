// SPDX-License-Identifier: Apache-2.0
// The lobes of both sides in the plane of incidence, and their directional albedos.

import { scaleLinear } from "d3-scale";
import { line, lineRadial } from "d3-shape";
import type { Triple, Vec3 } from "../data";
import { degrees, show } from "../format";
import { albedoDir, type Model } from "../models/table";
import type { Pair } from "../probe";
import type { SideName } from "../state";
import { LETTER } from "../view";

export interface Curve {
  readonly side: SideName;
  readonly model: Model;
}

interface PlotProps {
  readonly curves: readonly Curve[];
  readonly pair: Pair;
  readonly color: Vec3;
  readonly roughness: number;
}

const CHANNELS = ["red", "green", "blue"];

/** The channel with the largest reflectance, where differences are most visible. */
function brightest(color: Vec3): number {
  return color.indexOf(Math.max(...color));
}

const RADIUS = 120;
const REACH = 89; // degrees on each side of the normal
const STEEPEST = 1.2; // lights within this angle from the normal, in radians, fit into the plot

/** pi f by the angle of the light, for the probe's viewer. */
export function Polar({ curves, pair, color, roughness }: PlotProps) {
  const channel = brightest(color);
  const { wo } = pair;
  const value = (of: Model, angle: number): number => {
    const theta = (angle * Math.PI) / 180;
    const wi: Triple = [Math.sin(theta), 0, Math.cos(theta)];
    return Math.PI * of.brdf(wo, wi, color[channel]!, roughness);
  };
  const angles = Array.from({ length: 2 * REACH + 1 }, (_, k) => k - REACH);
  const lobes = curves.map(({ model }) =>
    angles.map((angle): [number, number] => [(angle * Math.PI) / 180, value(model, angle)]),
  );
  // Exclude grazing lights, whose values may diverge and exceed the plot.
  const inner = lobes.flatMap((lobe) => lobe.filter(([angle]) => Math.abs(angle) < STEEPEST));
  const top = Math.max(...inner.map(([, radius]) => radius), 1e-6);
  const radius = scaleLinear([0, top], [0, RADIUS]).nice(4);
  const draw = lineRadial<[number, number]>()
    .angle(([angle]) => angle)
    .radius(([, r]) => Math.min(Math.max(radius(r), 0), 1.4 * RADIUS));
  const thetaO = Math.acos(wo[2]);
  const thetaI = Math.atan2(pair.wi[0], pair.wi[2]);
  const out = RADIUS + 14;
  const to = (angle: number): [number, number] => [out * Math.sin(angle), -out * Math.cos(angle)];
  return (
    <figure>
      <svg
        class="plot"
        viewBox="-172 -146 344 166"
        role="img"
        aria-label={`Lobe in the plane of incidence, viewer at ${degrees(thetaO)}`}
      >
        {radius.ticks(4).map((tick) => (
          <g key={tick}>
            <path class="grid" d={halfCircle(radius(tick))} />
            {tick > 0 && (
              <text class="tick" x={-radius(tick)} y="13" text-anchor="middle">
                {show(tick)}
              </text>
            )}
          </g>
        ))}
        <line class="axis" x1="-160" x2="160" y1="0" y2="0" />
        <line class="grid" x1="0" x2="0" y1="0" y2={-RADIUS} />
        {lobes.map((lobe, k) => (
          <path key={curves[k]!.side} class={`curve ${curves[k]!.side}`} d={draw(lobe) ?? ""} />
        ))}
        <Ray angle={thetaO} end={to(thetaO)} name="eye" />
        <Ray angle={thetaI} end={to(thetaI)} name="light" />
      </svg>
      <figcaption>
        Lobe in the plane of incidence: π f over the light's angle, {CHANNELS[channel]} channel
      </figcaption>
    </figure>
  );
}

/** The upper half of a circle about the origin. */
function halfCircle(r: number): string {
  return `M${-r} 0A${r} ${r} 0 0 1 ${r} 0`;
}

interface RayProps {
  readonly angle: number;
  readonly end: readonly [number, number];
  readonly name: string;
}

function Ray({ angle, end: [x, y], name }: RayProps) {
  const anchor = Math.abs(angle) < 0.2 ? "middle" : angle > 0 ? "start" : "end";
  return (
    <g class="ray">
      <line x1="0" y1="0" x2={x} y2={y} />
      <circle cx={x} cy={y} r="3" />
      <text x={x + Math.sign(angle) * 6} y={y - 4} text-anchor={anchor}>
        {name}
      </text>
    </g>
  );
}

const [WIDTH, HEIGHT] = [300, 172];
const FRAME = { left: 36, right: 290, top: 12, bottom: 142 };
const POINTS = 31;

/** The directional albedos of both sides by the angle of the viewer, with the probe's angle. */
export function AlbedoPlot({ curves, pair, color, roughness }: PlotProps) {
  const channel = brightest(color);
  const rho = color[channel]!;
  const lines = curves.map(({ model }) =>
    Array.from({ length: POINTS }, (_, k): [number, number] => {
      const angle = (90 * k) / (POINTS - 1);
      const mu = Math.max(Math.cos((angle * Math.PI) / 180), 0.0);
      return [angle, albedoDir(model, mu, rho, roughness, 12)];
    }),
  );
  const all = lines.flat().map(([, y]) => y);
  const x = scaleLinear([0, 90], [FRAME.left, FRAME.right]);
  const y = scaleLinear(
    [Math.min(...all, rho) * 0.95, Math.max(...all, rho) * 1.02],
    [FRAME.bottom, FRAME.top],
  ).nice(4);
  const draw = line<[number, number]>(
    ([angle]) => x(angle),
    ([, albedo]) => y(albedo),
  );
  const angle = (Math.acos(Math.min(pair.wo[2], 1)) * 180) / Math.PI;
  const marks = curves.map(({ model }) => albedoDir(model, pair.wo[2], rho, roughness, 24));
  return (
    <figure>
      <svg
        class="plot"
        viewBox={`0 0 ${WIDTH} ${HEIGHT}`}
        role="img"
        aria-label={curves
          .map(({ side }, k) => `Directional albedo of ${LETTER[side]}: ${show(marks[k]!)}`)
          .join("; ")}
      >
        {y.ticks(4).map((tick) => (
          <g key={tick}>
            <line class="grid" x1={FRAME.left} x2={FRAME.right} y1={y(tick)} y2={y(tick)} />
            <text class="tick" x={FRAME.left - 5} y={y(tick) + 3.5} text-anchor="end">
              {show(tick)}
            </text>
          </g>
        ))}
        {[0, 30, 60, 90].map((tick) => (
          <text key={tick} class="tick" x={x(tick)} y={FRAME.bottom + 14} text-anchor="middle">
            {tick}°
          </text>
        ))}
        <line class="axis" x1={FRAME.left} x2={FRAME.right} y1={FRAME.bottom} y2={FRAME.bottom} />
        <line class="now" x1={x(angle)} x2={x(angle)} y1={FRAME.top} y2={FRAME.bottom} />
        {lines.map((points, k) => (
          <g key={curves[k]!.side} class={curves[k]!.side}>
            <path class={`curve ${curves[k]!.side}`} d={draw(points) ?? ""} />
            <circle class="mark" cx={x(angle)} cy={y(marks[k]!)} r="4" />
          </g>
        ))}
      </svg>
      <figcaption>
        Directional albedo over the viewer's angle, {CHANNELS[channel]} channel:{" "}
        {curves.map(({ side }, k) => `${LETTER[side]} ${show(marks[k]!, 4)}`).join(", ")} at{" "}
        {Math.round(angle)}°
      </figcaption>
    </figure>
  );
}
