// Opaque things as the sun sees them.
layout(location = 0) in vec3 corner;

uniform vec3 map_right, map_up, sun_direction;
uniform float map_radius; // metres

void main()
{
    gl_Position = vec4(dot(corner, map_right), dot(corner, map_up), -dot(corner, sun_direction), map_radius) / map_radius;
}
