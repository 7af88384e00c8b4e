// SPDX-License-Identifier: Apache-2.0
// Whether the light reaches the point of each pixel.

uniform highp sampler2D stage_surface;
uniform highp sampler2D stage_place;
uniform mat3 stage_camera;
uniform vec3 stage_light; // Unit vector towards the light, in the world frame.

out vec4 stage_lit;

void main()
{
    vec4 surface = texelFetch(stage_surface, ivec2(gl_FragCoord.xy), 0);
    vec3 normal = stage_camera * surface.xyz;
    vec3 p = stage_camera * texelFetch(stage_place, ivec2(gl_FragCoord.xy), 0).xyz;
    bool lit = surface.w > 0.0 && dot(normal, stage_light) > 0.0;
    if (lit)
        lit = stage_nearest(p + STAGE_OFFSET * normal, stage_light).t == STAGE_NEVER;
    stage_lit = vec4(lit);
}
