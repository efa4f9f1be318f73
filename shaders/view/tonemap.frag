// The window's picture from radiance: exposure, the curve of libshape/file/image_png.c, sRGB, a dither of one code.
uniform highp sampler2D accumulated;
uniform float exposure; // factor

layout(location = 0) out vec4 colour_out;

vec3 shoulder(vec3 x)
{
    const float A = 0.6;
    return mix(x, A + (1.0 - A) * (1.0 - exp(-(x - A) / (1.0 - A))), vec3(greaterThan(x, vec3(A))));
}

vec3 to_srgb(vec3 x)
{
    return mix(12.92 * x, 1.055 * pow(max(x, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055,
               vec3(greaterThan(x, vec3(0.0031308))));
}

void main()
{
    vec4 sum = texelFetch(accumulated, ivec2(gl_FragCoord.xy), 0);
    vec3 colour = to_srgb(shoulder(max(sum.rgb, vec3(0.0)) * exposure));
    float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
    colour_out = vec4(colour + dither / 255.0, 1.0);
}
