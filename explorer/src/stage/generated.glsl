// SPDX-License-Identifier: Apache-2.0
// The end of a shader that mxeon generated: a main function that provides the pixel's point.
//
// The shader's own main is renamed. The code below sets the variables that replace inputs from the
// vertex stage.

uniform highp sampler2D stage_surface;
uniform highp sampler2D stage_place;
uniform highp sampler2D stage_detail;
uniform highp sampler2D stage_lit;
uniform mat3 stage_camera;
uniform vec4 stage_frame;
uniform float stage_intensity;
// Fibers: (height of the center of the bend, 1). Other shapes: (0, 0).
uniform vec2 stage_bend;

void main()
{
    ivec2 stage_at = ivec2(gl_FragCoord.xy);
    vec4 stage_here = texelFetch(stage_surface, stage_at, 0);
    STAGE_OUTPUT = vec4(0.0);
    if (stage_here.w != 1.0)
        return;
    vec4 stage_position = texelFetch(stage_place, stage_at, 0);
    vec3 stage_normal = stage_here.xyz;
    vec2 stage_texcoord = texelFetch(stage_detail, stage_at, 0).xy;
    vec3 stage_beside = stage_camera * stage_normal;
    stage_beside = vec3(stage_beside.z, 0.0, -stage_beside.x);
    stage_beside = dot(stage_beside, stage_beside) > 0.0 ? stage_beside : vec3(1.0, 0.0, 0.0);
    if (stage_bend.y > 0.0)
        stage_beside = cross(stage_camera * stage_position.xyz - vec3(0.0, stage_bend.x, 0.0), vec3(0.0, 0.0, 1.0));
    vec3 stage_tangent = normalize(stage_beside) * stage_camera;
    float stage_lamp = texture(stage_lit, gl_FragCoord.xy / stage_frame.xy).x;
    u_numActiveLightSources = stage_lamp * stage_intensity > 0.0 ? 1 : 0;
    u_envLightIntensity = stage_position.w;
    STAGE_INPUTS
    stage_generated_main();
    STAGE_OUTPUT.w = 1.0;
}
