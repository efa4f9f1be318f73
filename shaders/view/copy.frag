// Copies a finished sample into the running mean; where it is asked to, only looks whether every pixel is finished.
uniform highp sampler2D part_radiance, part_work;
uniform int looking; // 1: pixels that are finished draw nothing, so that an occlusion query counts the others

layout(location = 0) out vec4 radiance_out;
layout(location = 1) out vec4 work_out;

void main()
{
    radiance_out = texelFetch(part_radiance, ivec2(gl_FragCoord.xy), 0);
    work_out = texelFetch(part_work, ivec2(gl_FragCoord.xy), 0);
    if (looking == 1 && work_out.z < 0.0)
        discard;
}
