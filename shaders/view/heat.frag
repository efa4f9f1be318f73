// What a picture took, as heat: black, red, yellow, white.
uniform highp sampler2D work; // steps, fetches
uniform float full;           // this many are white
uniform int fetches;          // 1: fetches rather than steps

layout(location = 0) out vec4 colour_out;

void main()
{
    vec4 pixel = texelFetch(work, ivec2(gl_FragCoord.xy), 0);
    float heat = clamp((fetches == 1 ? pixel.y : pixel.x) / full, 0.0, 1.0) * 3.0;
    colour_out = vec4(clamp(vec3(heat, heat - 1.0, heat - 2.0), 0.0, 1.0), 1.0);
}
