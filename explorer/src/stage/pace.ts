// SPDX-License-Identifier: Apache-2.0
// How finely a picture is drawn: at full resolution at rest, as finely as time allows while it moves.

import type { Size } from "./paths";

const SMOOTHING = 8; // frames that a picture at rest is the average of,
const LEAST_SMOOTHING = 2; // and where they take longer, as many as take so many
const SMOOTHING_BUDGET = 1000; // milliseconds
const MOVING_BUDGET = 24; // milliseconds of a frame while something moves: 30 frames a second
const PATHS_BUDGET = 120; // and of a pass of paths
const REST = 220; // milliseconds after which what changed last is at rest
const SMALLEST = 0.15; // share of the resolution that is kept
const FIRST_SHARE = 0.35; // that of the first picture of a material

export class Pace {
  moving = false; // and another state will follow soon
  private dragging = false;
  private first = true; // The first picture of a material is coarse, to be there soon.
  private changed = -Infinity; // when the state last did
  private timer = 0;
  private share = 1; // of the resolution
  private latest = 0; // milliseconds of the latest frame,
  private rate = 0; // and of each of its pixels

  /** `rest` is called when the picture comes to rest. */
  constructor(private readonly rest: () => void) {}

  /** Take note of a new state. */
  change(dragging: boolean): void {
    const now = performance.now();
    // A control that is moved calls often, too, without saying that it drags.
    const often = !this.dragging && now - this.changed < REST;
    this.moving = dragging || often;
    this.dragging = dragging;
    this.changed = now;
    clearTimeout(this.timer);
    if (often && !dragging) this.timer = window.setTimeout(this.stop, REST);
  }

  /** Take note of new materials, which may take longer. */
  renew(): void {
    this.first = true;
  }

  /** Choose the resolution of what is drawn from now on. */
  begin([width, height]: Size, paths: boolean): void {
    // What is dragged keeps one size, unless that is still too slow.
    if (this.moving && this.share < 1 && this.latest < 1.5 * MOVING_BUDGET) return;
    const budget = this.moving ? MOVING_BUDGET : paths ? PATHS_BUDGET : Infinity;
    const affordable = this.rate ? Math.sqrt(budget / (this.rate * width * height)) : 1;
    const share = this.first ? FIRST_SHARE : affordable;
    this.share = Math.min(Math.max(Math.floor(share * 20) / 20, SMALLEST), 1);
  }

  /** Size in which a picture is drawn that fills so much: even, as that is. */
  size([width, height]: Size): Size {
    const even = (length: number) => Math.max(2 * Math.round((length * this.share) / 2), 2);
    return this.share === 1 ? [width, height] : [even(width), even(height)];
  }

  /** Take note of how long a frame took. */
  measure(milliseconds: number, [width, height]: Size): void {
    this.latest = milliseconds;
    this.rate = milliseconds / (width * height);
    if (!this.first) return;
    this.first = false;
    this.stop();
  }

  /** Frames that a picture at rest is the average of; one while it moves. */
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
