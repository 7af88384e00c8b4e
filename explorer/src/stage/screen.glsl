// SPDX-License-Identifier: Apache-2.0
// Draws the averaged picture on the canvas. Small pictures are enlarged. Colors are sRGB.

uniform highp sampler2D stage_picture;
// Size of the canvas, and the part of the picture's texture that was drawn.
uniform vec4 stage_canvas;

out vec4 stage_screen;

vec3 stage_encoded(vec3 color)
{
    vec3 curved = 1.055 * pow(max(color, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
    return mix(12.92 * color, curved, step(vec3(0.0031308), color));
}

// Dithering by one step of the screen avoids banding. The offsets are Roberts' R2 sequence.
float stage_dither()
{
    return fract(dot(gl_FragCoord.xy, vec2(0.7548776662, 0.5698402910))) - 0.5;
}

void main()
{
    vec4 color = texture(stage_picture, gl_FragCoord.xy / stage_canvas.xy * stage_canvas.zw);
    vec3 encoded = stage_encoded(color.xyz / max(color.w, 1.0e-4)) + stage_dither() / 255.0;
    stage_screen = vec4(clamp(encoded, 0.0, 1.0) * color.w, color.w);
}
