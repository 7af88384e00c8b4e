// SPDX-License-Identifier: Apache-2.0
// Chooses the resolution of a picture: full at rest, and as fine as time permits in motion.

import type { Size } from "./paths";

const SMOOTHING = 8; // maximum number of frames averaged for a picture at rest
const LEAST_SMOOTHING = 2; // minimum number of averaged frames
const SMOOTHING_BUDGET = 1000; // milliseconds for all averaged frames
const MOVING_BUDGET = 24; // milliseconds per frame while something moves: 30 frames per second
const PATHS_BUDGET = 120; // milliseconds per pass of paths
const REST = 220; // milliseconds without a change until the picture is at rest
const SMALLEST = 0.15; // smallest fraction of the full resolution
const FIRST_SHARE = 0.35; // fraction of the full resolution for the first picture of a material

export class Pace {
  moving = false; // whether another state will follow soon
  private dragging = false;
  private first = true; // The first picture of a material is coarse, so that it appears quickly.
  private changed = -Infinity; // time of the last change of the state
  private timer = 0;
  private share = 1; // fraction of the full resolution
  private latest = 0; // milliseconds of the latest frame
  private rate = 0; // milliseconds per pixel of the latest frame

  /** `rest` is called when the picture comes to rest. */
  constructor(private readonly rest: () => void) {}

  /** Record a new state. */
  change(dragging: boolean): void {
    const now = performance.now();
    // While a control moves, states change often without a reported drag.
    const often = !this.dragging && now - this.changed < REST;
    this.moving = dragging || often;
    this.dragging = dragging;
    this.changed = now;
    clearTimeout(this.timer);
    if (often && !dragging) this.timer = window.setTimeout(this.stop, REST);
  }

  /** Record new materials, which may take longer. */
  renew(): void {
    this.first = true;
  }

  /** Choose the resolution for the next frames. */
  begin([width, height]: Size, paths: boolean): void {
    // Keep the size during a drag, unless frames still take too long.
    if (this.moving && this.share < 1 && this.latest < 1.5 * MOVING_BUDGET) return;
    const budget = this.moving ? MOVING_BUDGET : paths ? PATHS_BUDGET : Infinity;
    const affordable = this.rate ? Math.sqrt(budget / (this.rate * width * height)) : 1;
    const share = this.first ? FIRST_SHARE : affordable;
    this.share = Math.min(Math.max(Math.floor(share * 20) / 20, SMALLEST), 1);
  }

  /** Size to draw for a picture of the given full size; even, like the full size. */
  size([width, height]: Size): Size {
    const even = (length: number) => Math.max(2 * Math.round((length * this.share) / 2), 2);
    return this.share === 1 ? [width, height] : [even(width), even(height)];
  }

  /** Record how long a frame took. */
  measure(milliseconds: number, [width, height]: Size): void {
    this.latest = milliseconds;
    this.rate = milliseconds / (width * height);
    if (!this.first) return;
    this.first = false;
    this.stop();
  }

  /** Number of frames averaged for a picture at rest; 1 in motion. */
  frames([width, height]: Size): number {
    if (this.moving) return 1;
    const affordable = Math.floor(SMOOTHING_BUDGET / Math.max(this.rate * width * height, 1));
    return Math.min(Math.max(affordable, LEAST_SMOOTHING), SMOOTHING);
  }

  end(): void {
    clearTimeout(this.timer);
  }

  private readonly stop = (): void => {
    this.moving = this.dragging;
    this.rest();
  };
}
