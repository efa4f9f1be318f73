// What a picture took, or how deep it looks, as heat: black, red, yellow, white.
uniform highp sampler2D work;        // steps, fetches, and candidates in the fourth
uniform highp sampler2D accumulated; // coverage in the fourth
uniform float full;                  // this many are white
uniform int kind;                    // shape_gl_heat: steps, fetches, candidates, optical depth

layout(location = 0) out vec4 colour_out;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 pixel = texelFetch(work, at, 0);
    float value = kind == 0 ? pixel.x : kind == 1 ? pixel.y : pixel.w;
    if (kind == 3)
        value = -log(max(1.0 - texelFetch(accumulated, at, 0).a, 1e-6));
    float heat = clamp(value / full, 0.0, 1.0) * 3.0;
    colour_out = vec4(clamp(vec3(heat, heat - 1.0, heat - 2.0), 0.0, 1.0), 1.0);
}
