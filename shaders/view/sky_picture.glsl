// How view/sky.frag lays the sky out: texel (x, y) is the direction of pixel SKY_SPACING * (x, y).
uniform highp sampler2D sky_picture;
const float SKY_SPACING = 8.0;

// pixel: whole numbers, from the left and from below.
vec3 sky_behind(vec2 pixel)
{
    return texture(sky_picture, (pixel / SKY_SPACING + 0.5) / vec2(textureSize(sky_picture, 0))).rgb;
}
