// The sky, the mirror of libshape/light/sky.c: Preetham, Shirley and Smits 1999 in linear Rec. 709. The uniforms are the
// members of shape_sky; sky_perez holds A to E of Y, then of x, then of y.
uniform int sky_kind; // 0 none, 1 constant, 2 clear
uniform vec3 sky_constant;
uniform vec3 sky_sun;
uniform float sky_perez[15];
uniform vec3 sky_zenith; // Y, x, y
uniform vec3 sky_ground;
uniform float sky_night;

float sky_perez_value(int first, float cos_view, float angle, float cos_angle)
{
    return (1.0 + sky_perez[first] * exp(sky_perez[first + 1] / max(cos_view, 1e-3))) *
           (1.0 + sky_perez[first + 2] * exp(sky_perez[first + 3] * angle) +
            sky_perez[first + 4] * cos_angle * cos_angle);
}

// CIE 1931 xyY to linear Rec. 709; what lies outside the gamut is cut at 0.
vec3 sky_rgb(vec3 yxy)
{
    vec3 xyz = vec3(yxy.x * yxy.y / yxy.z, yxy.x, yxy.x * (1.0 - yxy.y - yxy.z) / yxy.z);
    return max(vec3(dot(vec3(3.2404542, -1.5371385, -0.4985314), xyz),
                    dot(vec3(-0.9692660, 1.8760108, 0.0415560), xyz),
                    dot(vec3(0.0556434, -0.2040259, 1.0572252), xyz)),
               vec3(0.0));
}

vec3 sky_clear(vec3 d)
{
    float up = max(d.y, 0.0);
    float cos_angle = clamp(dot(d, sky_sun), -1.0, 1.0);
    float angle = acos(cos_angle);
    float lifted = min(up + 0.08, 1.0); // see colour_lift in sky.c
    vec3 yxy = sky_zenith * vec3(sky_perez_value(0, up, angle, cos_angle), sky_perez_value(5, lifted, angle, cos_angle),
                                 sky_perez_value(10, lifted, angle, cos_angle));
    // Towards the CIE daylight locus: the model alone has a pink horizon by day and a green one at sunset.
    yxy.z = 0.25 * yxy.z + 0.75 * (-3.0 * yxy.y * yxy.y + 2.87 * yxy.y - 0.275);
    return mix(sky_rgb(yxy) * sky_night, sky_ground, smoothstep(0.0, 0.2, -d.y));
}

// Radiance from a direction (unit vector, where one looks); the sun's disc is not in it.
vec3 sky_radiance(vec3 direction)
{
    if (sky_kind == 2)
        return sky_clear(direction);
    return sky_kind == 1 ? sky_constant : vec3(0.0);
}
