// Triangles of opaque things, seen from the eye through the same place within the pixels as the sample's rays.
layout(location = 0) in vec3 corner; // relative to `middle`
layout(location = 1) in vec4 plane;  // unit normal; its distance from `middle` along it
layout(location = 2) in vec3 colour;

uniform vec3 middle; // of the things, relative to the eye
uniform vec3 camera_forward, camera_right, camera_up;
uniform vec2 picture_size, pixel_shift;

const float NEAREST = 1e-3; // metres before the eye

out vec3 place;           // relative to the eye
flat out vec4 face_plane; // its distance from the eye
flat out vec3 albedo;

void main()
{
    place = corner + middle;
    face_plane = vec4(plane.xyz, plane.w + dot(plane.xyz, middle));
    albedo = colour;
    float depth = dot(place, camera_forward);
    vec2 screen = vec2(dot(place, camera_right) / dot(camera_right, camera_right),
                       dot(place, camera_up) / dot(camera_up, camera_up));
    screen += (1.0 - 2.0 * pixel_shift) / picture_size * depth;
    gl_Position = vec4(screen, depth - 2.0 * NEAREST, depth); // no far plane: the fragments' depth is their own
}
