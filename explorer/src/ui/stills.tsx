// SPDX-License-Identifier: Apache-2.0
// Pictures for browsers without WebGL2.

import type { Still } from "../data";

export function Stills({ stills }: { readonly stills: readonly Still[] }) {
  return (
    <section class="stills" aria-label="Pictures">
      <p role="alert">
        This browser has no WebGL2, so nothing can be drawn here. These pictures were made before:
        color (0.8, 0.4, 0.1), roughness 1, lit from above and behind. All numbers work.
      </p>
      <div>
        {stills.map(({ title, picture }) => (
          <figure key={title}>
            <img src={picture} alt={`Sphere, ${title}`} width="176" height="176" />
            <figcaption>{title}</figcaption>
          </figure>
        ))}
      </div>
    </section>
  );
}
