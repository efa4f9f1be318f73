/* The sliders: what each turns, its unit, range and option. Ranges are those that a hand wants; the file may hold more,
 * and a value outside is shown as it is until it is changed. */
#include <stddef.h>

#include "state.h"

#define STATE(member) VIEW_OF_STATE, offsetof(view_state, member)
#define FIELD(member) VIEW_OF_FIELD, offsetof(shape_field, member)
#define MEDIUM(member) VIEW_OF_MEDIUM, offsetof(shape_medium, member)
#define CLOUD(member) VIEW_OF_CLOUD, offsetof(view_cloud, member)
#define MOTION(member) STATE(course.motion.member)

const view_knob view_knobs[] = {
    {"Field", "kappa", "", "kappa", FIELD(kappa), VIEW_KNOB_FLOAT, 0, 1, false,
     "share of noise in a spheroid's edge"},
    {"Field", "octaves", "", "octaves", FIELD(octaves), VIEW_KNOB_INT, 1, 16, false, "octaves of noise"},
    {"Field", "noise scale", "m", "noise-scale", FIELD(noise_scale), VIEW_KNOB_FLOAT, 1e-3, 1e3, true,
     "edge of a cell of the first octave"},
    {"Field", "edge", "", "edge", FIELD(edge), VIEW_KNOB_FLOAT, 0, 20, false,
     "metaballs: how much noise a field of 1 must outweigh"},
    {"Field", "smoothness", "", "smoothness", FIELD(detail.smoothness), VIEW_KNOB_FLOAT, 0, 1, false,
     "smooth union: how far two surfaces that meet bulge"},
    {"Field", "billow", "", "billow", FIELD(detail.billow), VIEW_KNOB_FLOAT, 0, 1, false,
     "erosion into billows towards the top"},
    {"Field", "wisp", "", "wisp", FIELD(detail.wisp), VIEW_KNOB_FLOAT, 0, 1, false,
     "erosion into wisps towards the base"},
    {"Field", "displace", "m", "displace", FIELD(detail.displace), VIEW_KNOB_FLOAT, 0, 10, false,
     "how far vector noise moves points"},
    {"Field", "displace scale", "m", "displace-scale", FIELD(detail.displace_scale), VIEW_KNOB_FLOAT, 0, 100,
     false, "a cell of that noise; 0: five times the noise scale"},
    {"Field", "detail depth", "", "detail-depth", FIELD(detail.detail_depth), VIEW_KNOB_FLOAT, 0, 1, false,
     "how deep billows and wisps reach, a share of the radius; 0: a half"},
    {"Field", "detail scale", "m", "detail-scale", FIELD(detail.detail_scale), VIEW_KNOB_FLOAT, 0, 100, false,
     "a cell of their noise; 0: twice the noise scale"},
    {"Medium", "extinction", "1/m", "extinction", MEDIUM(extinction), VIEW_KNOB_FLOAT, 1e-3, 1e3, true,
     "at density 1"},
    {"Medium", "albedo", "", "albedo", MEDIUM(albedo), VIEW_KNOB_FLOAT, 0, 1, false,
     "of a single scattering"},
    {"Medium", "g", "", "g", MEDIUM(g), VIEW_KNOB_FLOAT, -0.99, 0.99, false,
     "mean cosine of hg and of the first of two lobes"},
    {"Medium", "g2", "", "g2", MEDIUM(g2), VIEW_KNOB_FLOAT, -0.99, 0.99, false,
     "mean cosine of the second of two lobes"},
    {"Medium", "lobe mix", "", "lobe-mix", MEDIUM(lobe_mix), VIEW_KNOB_FLOAT, 0, 1, false,
     "weight of the second lobe"},
    {"Medium", "droplet", "um", "droplet", MEDIUM(droplet), VIEW_KNOB_FLOAT, 5, 50, false,
     "diameter, for mie"},
    {"Place", "move x", "m", NULL, CLOUD(move[0]), VIEW_KNOB_DOUBLE, -1000, 1000, false, "east"},
    {"Place", "move y", "m", NULL, CLOUD(move[1]), VIEW_KNOB_DOUBLE, -1000, 1000, false, "up"},
    {"Place", "move z", "m", NULL, CLOUD(move[2]), VIEW_KNOB_DOUBLE, -1000, 1000, false, "south"},
    {"Place", "turn x", "deg", NULL, CLOUD(turn[0]), VIEW_KNOB_DOUBLE, -180, 180, false, ""},
    {"Place", "turn y", "deg", NULL, CLOUD(turn[1]), VIEW_KNOB_DOUBLE, -180, 180, false, ""},
    {"Place", "turn z", "deg", NULL, CLOUD(turn[2]), VIEW_KNOB_DOUBLE, -180, 180, false, ""},
    {"Place", "scale", "", NULL, CLOUD(scale), VIEW_KNOB_DOUBLE, 0.01, 100, true, "a factor"},
    {"Sun", "azimuth", "deg", NULL, STATE(sun[0]), VIEW_KNOB_DOUBLE, -180, 180, false,
     "from +z (south) towards +x (east)"},
    {"Sun", "height", "deg", NULL, STATE(sun[1]), VIEW_KNOB_DOUBLE, -90, 90, false, "above the horizon"},
    {"Day", "hour", "h", "day", STATE(course.day.hour), VIEW_KNOB_DOUBLE, 0, 24, false, "solar time"},
    {"Day", "latitude", "deg", "latitude", STATE(course.day.latitude), VIEW_KNOB_DOUBLE, -90, 90, false,
     "north is above 0"},
    {"Day", "declination", "deg", "declination", STATE(course.day.declination), VIEW_KNOB_DOUBLE, -23.44,
     23.44, false, "of the sun: 23.44 in June"},
    {"Day", "day speed", "h/s", "day-speed", STATE(course.day_speed), VIEW_KNOB_DOUBLE, -24, 24, false,
     "hours of the day a second"},
    {"Air", "visibility", "m", "visibility", STATE(air.visibility), VIEW_KNOB_DOUBLE, 1, 100000, true,
     "how far away a black thing is just told from the sky"},
    {"Air", "air height", "m", "air-height", STATE(air.height), VIEW_KNOB_DOUBLE, 0, 20000, false,
     "over which the air thins by a factor e; 0: alike at all heights"},
    {"Light", "powder", "", "powder", STATE(lighting.powder), VIEW_KNOB_DOUBLE, 0, 20, false,
     "k of the powder lights: how soon their dark rims end"},
    {"Light", "light octaves", "", "light-octaves", STATE(lighting.octaves), VIEW_KNOB_INT, 1, 8, false,
     "copies of the sun's light that octaves sum, each reaching twice as deep"},
    {"Camera", "field of view", "deg", "fov", STATE(fov), VIEW_KNOB_DOUBLE, 1, 150, false, "vertical"},
    {"Camera", "exposure", "stops", "exposure", STATE(exposure), VIEW_KNOB_FLOAT, -10, 10, false, ""},
    {"Quality", "samples", "", "samples", STATE(samples), VIEW_KNOB_INT, 1, 1024, true,
     "a pixel of a picture at rest"},
    {"Quality", "light grid", "cells", "light-grid", STATE(light_grid), VIEW_KNOB_INT, 2, 128, false,
     "along a cloud's longest side"},
    {"Time", "time", "s", NULL, STATE(time), VIEW_KNOB_DOUBLE, 0, 60, false, ""},
    {"Time", "shear", "1/s", "shear", MOTION(shear), VIEW_KNOB_DOUBLE, -1, 1, false,
     "how much faster the wind is a metre higher"},
    {"Time", "life", "s", "life", MOTION(life), VIEW_KNOB_DOUBLE, 0, 120, false,
     "of a primitive, again and again; 0: for ever"},
    {"Time", "grow", "s", "grow", MOTION(grow), VIEW_KNOB_DOUBLE, 0, 120, false,
     "out of their bases; 0: the clouds are there"},
    {"Time", "turntable", "s", "turntable", STATE(course.turn_seconds), VIEW_KNOB_DOUBLE, 0, 120, false,
     "a turn of the eye; 0: it stands"},
};
const size_t view_knob_count = sizeof view_knobs / sizeof *view_knobs;

void *view_knob_value(const view_knob *knob, view_state *state, int cloud)
{
    char *base = (char *)state;
    if (knob->of == VIEW_OF_FIELD)
        base = (char *)&state->clouds[cloud].field;
    else if (knob->of == VIEW_OF_MEDIUM)
        base = (char *)&state->clouds[cloud].medium;
    else if (knob->of == VIEW_OF_CLOUD)
        base = (char *)&state->clouds[cloud];
    return base + knob->offset;
}

double view_knob_get(const view_knob *knob, const view_state *state, int cloud)
{
    const void *value = view_knob_value(knob, (view_state *)state, cloud);
    if (knob->kind == VIEW_KNOB_FLOAT)
        return (double)*(const float *)value;
    return knob->kind == VIEW_KNOB_INT ? (double)*(const int *)value : *(const double *)value;
}

void view_knob_set(const view_knob *knob, view_state *state, int cloud, double number)
{
    void *value = view_knob_value(knob, state, cloud);
    if (knob->kind == VIEW_KNOB_FLOAT)
        *(float *)value = (float)number;
    else if (knob->kind == VIEW_KNOB_INT)
        *(int *)value = (int)number;
    else
        *(double *)value = number;
}
