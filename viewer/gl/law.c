/* How a point of a cloud is lit, where that is not by the light pass's grid of all scatterings but by a law of the optical
 * depth to the sun (shaders/light/law.glsl, the mirror of libshape/light/march_light.c); and what lights it besides: ambient
 * light and emission. Each law has programs of its own, so that one that is off costs nothing. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gl_private.h"

enum { DEPTH_UNIT = 9, GLOW_TEXEL = 35 };

shape_gl_law gl_law(const shape_gl_renderer *r)
{
    return r->options.method <= SHAPE_GL_EXACT ? r->options.lighting.law : SHAPE_GL_LAW_GRID;
}

bool gl_law_has_sky(shape_gl_law law)
{
    return law == SHAPE_GL_LAW_GRID || law == SHAPE_GL_LAW_OCTAVES;
}

void gl_law_define(const shape_gl_renderer *r, char *defines, size_t size)
{
    size_t used = strlen(defines);
    if (gl_law(r) != SHAPE_GL_LAW_GRID)
        snprintf(defines + used, size - used, "#define LAW %d\n", (int)gl_law(r));
}

/* Radiance per unit of extinction that is the same all over a cloud. One that takes nothing away cannot glow here. */
static void find_glow(const shape_gl_renderer *r, const shape_medium *medium, float glow[3])
{
    const shape_gl_lighting *l = &r->options.lighting;
    for (int c = 0; c < 3; c++) {
        glow[c] = medium->albedo * l->ambient[c];
        if (medium->extinction > 0)
            glow[c] += fminf(l->emission[c] / medium->extinction, 1e30f);
    }
}

void gl_law_glow(const shape_gl_renderer *r, const shape_medium *medium, size_t cells, float *rgba)
{
    float glow[3];
    find_glow(r, medium, glow);
    if (glow[0] == 0 && glow[1] == 0 && glow[2] == 0)
        return;
    for (size_t i = 0; i < cells; i++)
        for (int c = 0; c < 3; c++)
            rgba[4 * i + (size_t)c] += glow[c];
}

void gl_law_place(const shape_gl_renderer *r, gl_scene *scene)
{
    for (size_t i = 0; i < r->volume->cloud_count; i++)
        find_glow(r, &r->volume->clouds[i].medium, scene->records + (i * GL_RECORD_TEXELS + GLOW_TEXEL) * 4);
}

/* The weights of the copies of SHAPE_MARCH_OCTAVES, 1 in all; those that are not summed have none. */
static void find_weights(int octaves, float weights[8])
{
    double weight = 0.5 / (1 - ldexp(1, -octaves));
    for (int k = 0; k < 8; k++, weight /= 2)
        weights[k] = k < octaves ? (float)weight : 0;
}

void gl_set_law(const shape_gl_renderer *r, const gl_grids *grids, GLuint program)
{
    float weights[8], sky[3];
    if (gl_law(r) == SHAPE_GL_LAW_GRID) {
        gl_set_dvector(program, "beam_sun_direction", r->light.sun);
        gl_set_vector(program, "beam_sun", r->light.sun_irradiance);
        return;
    }
    find_weights(r->options.lighting.octaves, weights);
    for (int c = 0; c < 3; c++)
        sky[c] = 0.5f * (r->sky_upper[c] + r->sky_lower[c]);
    gl_bind(program, "light_depth", DEPTH_UNIT, GL_TEXTURE_3D, grids->light->depth);
    gl_set_dvector(program, "law_sun_direction", r->light.sun);
    gl_set_vector(program, "law_sun", r->light.sun_irradiance);
    gl_set_vector(program, "law_sky", sky);
    gl_set_float(program, "law_powder", r->options.lighting.powder);
    glUniform1fv(glGetUniformLocation(program, "law_weights"), 8, weights);
}

shape_status gl_law_check(const shape_gl_lighting *l, shape_error *error)
{
    if (l->law < SHAPE_GL_LAW_GRID || l->law > SHAPE_GL_LAW_OCTAVES)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "lighting: there is no law of that number");
    if (!(l->powder >= 0 && l->powder <= 1000))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "lighting: powder must be from 0 to 1000");
    if (l->octaves < 1 || l->octaves > 8)
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "lighting: octaves must be from 1 to 8");
    for (int c = 0; c < 3; c++)
        if (!(l->ambient[c] >= 0 && l->ambient[c] <= 1e9f && l->emission[c] >= 0 && l->emission[c] <= 1e9f))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "lighting: ambient and emission must be from 0 to 1e9");
    return SHAPE_OK;
}
