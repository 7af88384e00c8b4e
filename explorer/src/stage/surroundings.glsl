// SPDX-License-Identifier: Apache-2.0
// Maps a direction of the world to a latitude-longitude map of the surroundings, as in MaterialX.
vec2 stage_latlong(vec3 direction)
{
    float longitude = atan(direction.x, -direction.z) / (2.0 * 3.14159265358979) + 0.5;
    return vec2(longitude, 0.5 - asin(clamp(direction.y, -1.0, 1.0)) / 3.14159265358979);
}
