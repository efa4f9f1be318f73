/* Air (shape/air.h): before the clouds are marched, the shadow of the air is laid out in slices at reduced resolution, from the
 * clouds' light grids and the things' map; the marching shaders look it up. Shaders without air are other programs, so that
 * it costs nothing where there is none. The layout stands in shaders/view/air_layout.glsl. */
#include <math.h>
#include <string.h>

#include "gl_private.h"
#include "shape/air.h"

enum { SPACING = 8, SLICES = 32, ACROSS = 4, LOOKS = 4, MOVING_LOOKS = 2, SHADOW_UNIT = 17, DARK_UNIT = 18 };

bool gl_has_air(const shape_gl_renderer *r)
{
    return shape_air_is(&r->light.air) && r->options.method <= SHAPE_GL_EXACT;
}

void gl_air_free(gl_air *air)
{
    glDeleteProgram(air->slice);
    glDeleteProgram(air->sum);
    glDeleteTextures(2, air->textures);
    glDeleteFramebuffers(2, air->framebuffers);
    glDeleteTextures(1, &air->clouds);
    memset(air, 0, sizeof *air);
}

static shape_status make_programs(gl_air *air, const char *folder, shape_error *error)
{
    shape_status status = SHAPE_OK;
    if (!air->slice)
        status =
            gl_program_create(folder, "view/fullscreen.vert", "view/air_slice.frag", "", &air->slice, error);
    if (!status && !air->sum)
        status = gl_program_create(folder, "view/fullscreen.vert", "view/air_sum.frag", "", &air->sum, error);
    return status;
}

static void make_texture(gl_air *air, int which)
{
    glBindTexture(GL_TEXTURE_2D, air->textures[which]);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, which ? GL_LINEAR : GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, which ? GL_LINEAR : GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, air->size[0] * ACROSS, air->size[1] * (SLICES / ACROSS), 0,
                 GL_RED, GL_FLOAT, NULL);
    glBindFramebuffer(GL_FRAMEBUFFER, air->framebuffers[which]);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, air->textures[which], 0);
}

/* Programs and textures for a picture of that size. */
static shape_status prepare(gl_air *air, const char *folder, const gl_frame *frame, shape_error *error)
{
    const int size[2] = {frame->part->width / SPACING + 2, frame->part->height / SPACING + 2};
    shape_status status = make_programs(air, folder, error);
    if (status || !memcmp(size, air->size, sizeof size))
        return status;
    memcpy(air->size, size, sizeof size);
    if (!air->textures[0]) {
        glGenTextures(2, air->textures);
        glGenFramebuffers(2, air->framebuffers);
        glGenTextures(1, &air->clouds);
        glBindTexture(GL_TEXTURE_2D, air->clouds);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    make_texture(air, 0);
    make_texture(air, 1);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return shape_error_set(error, SHAPE_ERROR_SYSTEM,
                               "this GPU cannot draw into 32-bit float textures (leave --visibility out)");
    return SHAPE_OK;
}

/* The ball around all that throws shadows but the ground; radius 0 where there is nothing. */
static void find_ball(const shape_gl_renderer *r, shape_dvec3 *middle, double *radius)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < r->volume->cloud_count; i++) {
        shape_dvec3 box[2];
        if (shape_box_is_empty(r->volume->clouds[i].box))
            continue;
        shape_frame_box(&r->volume->clouds[i].frame, r->volume->clouds[i].box, &box[0], &box[1]);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], (&box[0].x)[a]);
            high[a] = fmax(high[a], (&box[1].x)[a]);
        }
    }
    for (int a = 0; a < 3 && r->surface.solid_count; a++) {
        low[a] = fmin(low[a], (&r->surface.middle.x)[a] - (double)r->surface.radius);
        high[a] = fmax(high[a], (&r->surface.middle.x)[a] + (double)r->surface.radius);
    }
    *radius = 0;
    *middle = r->light.sun;
    if (!(low[0] <= high[0]))
        return;
    shape_dvec3 a = {low[0], low[1], low[2]}, b = {high[0], high[1], high[2]};
    *middle = shape_dvec3_scale(shape_dvec3_add(a, b), 0.5);
    *radius = shape_dvec3_length(shape_dvec3_sub(b, a)) / 2;
}

/* What all programs with air are told; in use. */
static void set_ray(const shape_gl_renderer *r, GLuint program, shape_dvec3 eye)
{
    shape_dvec3 middle;
    double radius, height = r->light.air.height;
    find_ball(r, &middle, &radius);
    gl_set_float(program, "air_extinction", (float)shape_air_extinction(&r->light.air, eye.y));
    gl_set_float(program, "air_thinning", height > 0 ? (float)(1 / height) : 0);
    gl_set_dvector(program, "air_ball", shape_dvec3_sub(middle, eye));
    gl_set_float(program, "air_radius", (float)radius);
    gl_set_dvector(program, "sun_direction", r->light.sun);
    glUniform2i(glGetUniformLocation(program, "air_size"), r->air.size[0], r->air.size[1]);
}

static void draw_into(const shape_gl_renderer *r, int which)
{
    glBindFramebuffer(GL_FRAMEBUFFER, r->air.framebuffers[which]);
    glViewport(0, 0, r->air.size[0] * ACROSS, r->air.size[1] * (SLICES / ACROSS));
    gl_draw_triangle(r);
}

shape_status gl_air_draw(shape_gl_renderer *r, const gl_frame *frame, shape_error *error)
{
    gl_air *air = &r->air;
    shape_dvec3 eye = frame->camera->origin;
    if (!gl_has_air(r))
        return SHAPE_OK;
    shape_status status = prepare(air, r->options.shader_folder, frame, error);
    if (status)
        return status;
    glDisable(GL_BLEND);
    glUseProgram(air->slice);
    gl_set_camera(frame, air->slice);
    set_ray(r, air->slice, eye);
    status = gl_shade_set(r, air->slice, air->clouds, eye, error);
    gl_set_things(r, air->slice, eye);
    gl_set_int(air->slice, "air_things", r->surface.count > 0);
    gl_set_int(air->slice, "air_looks", frame->moving ? MOVING_LOOKS : LOOKS);
    if (status)
        return status;
    draw_into(r, 0);
    glUseProgram(air->sum);
    gl_set_camera(frame, air->sum);
    set_ray(r, air->sum, eye);
    gl_bind(air->sum, "air_dark", DARK_UNIT, GL_TEXTURE_2D, air->textures[0]);
    draw_into(r, 1);
    return SHAPE_OK;
}

void gl_set_air(const shape_gl_renderer *r, GLuint program, shape_dvec3 eye)
{
    float mean[3];
    if (!gl_has_air(r))
        return;
    for (int c = 0; c < 3; c++) /* shape_air_mean */
        mean[c] = 0.5f * (r->sky_upper[c] + r->sky_lower[c]);
    set_ray(r, program, eye);
    gl_set_vector(program, "sun_irradiance", r->light.sun_irradiance);
    gl_set_vector(program, "air_sky_mean", mean);
    gl_set_int(program, "sky_hidden", r->options.no_background);
    gl_bind(program, "air_shadow", SHADOW_UNIT, GL_TEXTURE_2D, r->air.textures[1]);
}
