/* By what the clouds are lit. Names and meanings are those of neph-render's options of --method march; docs/light.md has each
 * law's formula and source. */
#include "lighting.h"

static struct light_values {
    int law;
    int64_t octaves;
    double powder, ambient[3], emission[3];
} values = {.octaves = 8, .powder = 2};

const cli_option view_light_options[] = {
    {"light", 0, CLI_CHOICE, &values.law, 0, 0, VIEW_LAW_WORDS,
     "how a point is lit; docs/light.md has each formula; the reference has none but the grid's [grid]", NULL,
     true},
    {"powder", 0, CLI_NUMBER, &values.powder, 0, 1000, "K", "of the powder lights, 1 - exp(-K depth) [2]",
     NULL, true},
    {"light-octaves", 0, CLI_INTEGER, &values.octaves, 1, 8, "N",
     "--light octaves: copies that are summed [8]", NULL, true},
    {"ambient", 0, CLI_VECTOR, values.ambient, 0, 1e9, "R,G,B",
     "radiance that reaches every point of a cloud alike from all round [0,0,0]", NULL, true},
    {"emission", 0, CLI_VECTOR, values.emission, 0, 1e9, "R,G,B",
     "density 1 glows with that radiance a metre [0,0,0]", NULL, true},
    {0}};

view_lighting view_lighting_given(void)
{
    view_lighting lighting = {.law = values.law, .octaves = (int)values.octaves, .powder = values.powder};
    for (int c = 0; c < 3; c++) {
        lighting.ambient[c] = values.ambient[c];
        lighting.emission[c] = values.emission[c];
    }
    return lighting;
}

void view_lighting_check(const view_lighting *lighting, int method)
{
    int law = lighting->law;
    const char *name = cli_given_of(view_light_options);
    if (method >= SHAPE_GL_PAPER && name)
        cli_wrong("--%s: the methods of 2018 have a light of their own (choose default or exact)", name);
    if (method >= SHAPE_GL_PAPER && law != SHAPE_GL_LAW_GRID)
        cli_say("note: the scene's light is not shown by the methods of 2018");
    if (cli_given("powder") && law != SHAPE_GL_LAW_POWDER && law != SHAPE_GL_LAW_POWDER_ANGLE)
        cli_wrong("--powder goes with --light powder and powder-angle");
    if (cli_given("light-octaves") && law != SHAPE_GL_LAW_OCTAVES)
        cli_wrong("--light-octaves goes with --light octaves");
}

shape_gl_lighting view_lighting_gl(const view_lighting *lighting)
{
    shape_gl_lighting gl = {
        .law = (shape_gl_law)lighting->law, .powder = (float)lighting->powder, .octaves = lighting->octaves};
    for (int c = 0; c < 3; c++) {
        gl.ambient[c] = (float)lighting->ambient[c];
        gl.emission[c] = (float)lighting->emission[c];
    }
    return gl;
}
