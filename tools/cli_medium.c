/* The medium and frame options that every program which makes or changes a cloud has. */
#include "cli.h"

#define DEFAULTS                                                                                             \
    {                                                                                                        \
        .model = SHAPE_MODEL_SPHEROID, .extinction = 2, .albedo = 1, .g = 0.85, .g2 = -0.3, .lobe_mix = 0.3, \
        .droplet = 10, .kappa = 0.5, .octaves = 5, .edge = 4.2                                               \
    }

const cli_medium cli_medium_defaults = DEFAULTS;
cli_medium cli_medium_values = DEFAULTS;

#define GIVEN(name) &cli_medium_values.name##_given, false
#define VALUE(name) &cli_medium_values.name

const cli_option cli_medium_options[] = {
    {"model", 0, CLI_CHOICE, VALUE(model), 0, 0, "uniform|spheroid|metaball|layer",
     "density model [spheroid]", GIVEN(model)},
    {"extinction", 0, CLI_NUMBER, VALUE(extinction), 0, 1e9, "S", "extinction at density 1, 1/m [2]",
     GIVEN(extinction)},
    {"albedo", 0, CLI_NUMBER, VALUE(albedo), 0, 1, "W", "single-scattering albedo, 0 to 1 [1]",
     GIVEN(albedo)},
    {"phase", 0, CLI_CHOICE, VALUE(phase), 0, 0, "hg|isotropic|rayleigh|mie|two-lobe", "phase function [hg]",
     GIVEN(phase)},
    {"g", 0, CLI_NUMBER, VALUE(g), -0.9999, 0.9999, "G",
     "mean cosine of hg and of the first of two lobes [0.85]", GIVEN(g)},
    {"g2", 0, CLI_NUMBER, VALUE(g2), -0.9999, 0.9999, "G", "mean cosine of the second of two lobes [-0.3]",
     GIVEN(g2)},
    {"lobe-mix", 0, CLI_NUMBER, VALUE(lobe_mix), 0, 1, "W", "weight of the second lobe, 0 to 1 [0.3]",
     GIVEN(lobe_mix)},
    {"droplet", 0, CLI_NUMBER, VALUE(droplet), 5, 50, "D",
     "droplet diameter of mie, micrometres, 5 to 50 [10]", GIVEN(droplet)},
    {"kappa", 0, CLI_NUMBER, VALUE(kappa), 0, 1, "K", "share of noise in a spheroid's edge, 0 to 1 [0.5]",
     GIVEN(kappa)},
    {"octaves", 0, CLI_INTEGER, VALUE(octaves), 1, 16, "N", "octaves of noise, 1 to 16 [5]", GIVEN(octaves)},
    {"noise-scale", 0, CLI_NUMBER, VALUE(noise_scale), 1e-9, 1e9, "L",
     "metres a cell of the first octave [a fifth of the median radius]", GIVEN(noise_scale)},
    {"edge", 0, CLI_NUMBER, VALUE(edge), 0, 1e9, "E",
     "metaball: how much noise a field of 1 must outweigh [4.2]", GIVEN(edge)},
    {"smoothness", 0, CLI_NUMBER, VALUE(smoothness), 0, 1, "K",
     "smooth union: how far two surfaces that meet bulge, a share of their radius, 0 to 1 [0]",
     GIVEN(smoothness)},
    {"displace", 0, CLI_NUMBER, VALUE(displace), 0, 1e9, "L",
     "move points by vector noise, at most so many metres [0]", GIVEN(displace)},
    {"displace-scale", 0, CLI_NUMBER, VALUE(displace_scale), 0, 1e9, "L",
     "metres a cell of that noise; 0: five times the noise scale [0]", GIVEN(displace_scale)},
    {"billow", 0, CLI_NUMBER, VALUE(billow), 0, 1, "B",
     "erode into billows towards the top, a share of the detail depth, 0 to 1 [0]", GIVEN(billow)},
    {"wisp", 0, CLI_NUMBER, VALUE(wisp), 0, 1, "W",
     "erode into wisps towards the base, a share of the detail depth, 0 to 1 [0]", GIVEN(wisp)},
    {"detail-depth", 0, CLI_NUMBER, VALUE(detail_depth), 0, 1, "D",
     "how deep billows and wisps reach, a share of the radius, 0 to 1; 0: a half [0]", GIVEN(detail_depth)},
    {"detail-scale", 0, CLI_NUMBER, VALUE(detail_scale), 0, 1e9, "L",
     "metres a cell of their noise; 0: twice the noise scale [0]", GIVEN(detail_scale)},
    {"at", 0, CLI_VECTOR, VALUE(at), -1e12, 1e12, "X,Y,Z", "where the cloud is placed, metres [0,0,0]",
     GIVEN(at)},
    {0}};

static void apply_details(shape_detail *detail)
{
    const cli_medium *v = &cli_medium_values;
    const struct {
        bool given;
        double value;
        float *to;
    } all[] = {{v->smoothness_given, v->smoothness, &detail->smoothness},
               {v->displace_given, v->displace, &detail->displace},
               {v->displace_scale_given, v->displace_scale, &detail->displace_scale},
               {v->billow_given, v->billow, &detail->billow},
               {v->wisp_given, v->wisp, &detail->wisp},
               {v->detail_depth_given, v->detail_depth, &detail->detail_depth},
               {v->detail_scale_given, v->detail_scale, &detail->detail_scale}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i].given)
            *all[i].to = (float)all[i].value;
}

void cli_medium_apply(shape_cloud *cloud)
{
    const cli_medium *v = &cli_medium_values;
    shape_field *field = &cloud->field;
    shape_medium *medium = &cloud->medium;
    if (v->model_given)
        field->model = (shape_model)v->model;
    if (v->kappa_given)
        field->kappa = (float)v->kappa;
    if (v->octaves_given)
        field->octaves = (int)v->octaves;
    if (v->noise_scale_given)
        field->noise_scale = (float)v->noise_scale;
    if (v->edge_given)
        field->edge = (float)v->edge;
    if (v->extinction_given)
        medium->extinction = (float)v->extinction;
    if (v->albedo_given)
        medium->albedo = (float)v->albedo;
    if (v->phase_given)
        medium->phase = (shape_phase_kind)v->phase;
    if (v->g_given)
        medium->g = (float)v->g;
    if (v->g2_given)
        medium->g2 = (float)v->g2;
    if (v->lobe_mix_given)
        medium->lobe_mix = (float)v->lobe_mix;
    if (v->droplet_given)
        medium->droplet = (float)v->droplet;
    apply_details(&field->detail);
    for (int i = 0; i < 3 && v->at_given; i++)
        cloud->frame.m[i][3] += v->at[i];
}
