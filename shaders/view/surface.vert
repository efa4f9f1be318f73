// Triangles of opaque things, seen from the eye through the same place within the pixels as the sample's rays.
layout(location = 0) in vec3 corner; // relative to `middle`
layout(location = 1) in vec4 plane;  // unit normal; its distance from `middle` along it
layout(location = 2) in vec3 colour;

uniform vec3 middle; // of the things, relative to the eye
uniform vec3 camera_forward, camera_right, camera_up;
uniform vec2 picture_size, picture_origin, pixel_shift;
uniform vec2 part_size; // of what is drawn of the picture
uniform int is_ground; // 1: a triangle over the whole picture
uniform float ground;
uniform vec3 ground_colour;

const float NEAREST = 1e-3; // metres before the eye

out vec3 place;           // relative to the eye
flat out vec4 face_plane; // its distance from the eye
flat out vec3 albedo;

void main()
{
    if (is_ground == 1) {
        vec2 side = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
        gl_Position = vec4(side * 2.0 - 1.0, 0.0, 1.0);
        place = vec3(0.0);
        face_plane = vec4(0.0, 1.0, 0.0, ground);
        albedo = ground_colour;
        return;
    }
    place = corner + middle;
    face_plane = vec4(plane.xyz, plane.w + dot(plane.xyz, middle));
    albedo = colour;
    float depth = dot(place, camera_forward);
    vec2 screen = vec2(dot(place, camera_right) / dot(camera_right, camera_right),
                       dot(place, camera_up) / dot(camera_up, camera_up));
    // From the whole picture's borders to the part's, and from the pixels' middles to the sample's places within them.
    vec2 low = 2.0 * picture_origin / picture_size - 1.0, size = 2.0 * part_size / picture_size;
    screen = (screen - low * depth) / size * 2.0 - depth + (1.0 - 2.0 * pixel_shift) / part_size * depth;
    gl_Position = vec4(screen, depth - 2.0 * NEAREST, depth); // no far plane: the fragments' depth is their own
}
