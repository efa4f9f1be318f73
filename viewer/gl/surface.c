/* Opaque things: drawn as triangles into radiance and distance before the clouds are marched, which then end there. Each
 * sample sees them through its own places within the pixels, so that their edges become smooth with the samples, and no
 * pixel mixes a near distance with a far one. The ground is no triangle but a plane that all rays are asked about: what is
 * clipped from so large a triangle is off by pixels. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

enum { MAP_SIDE = 2048, VERTEX_FLOATS = 10 };

/* --- triangles --- */

/* Middle and half diagonal of what is not the ground. */
static void find_extent(gl_surface *s, const shape_opaque *opaque)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < shape_opaque_triangle_count(opaque); i++) {
        shape_opaque_triangle t = shape_opaque_get_triangle(opaque, i);
        if (t.ground) {
            s->has_ground = true;
            s->ground = t.corner[0].y;
            memcpy(s->ground_colour, t.albedo, sizeof s->ground_colour);
            continue;
        }
        s->solid_count++;
        for (int k = 0; k < 3; k++) {
            const double p[3] = {t.corner[k].x, t.corner[k].y, t.corner[k].z};
            for (int a = 0; a < 3; a++) {
                low[a] = fmin(low[a], p[a]);
                high[a] = fmax(high[a], p[a]);
            }
        }
    }
    if (!s->solid_count) {
        s->middle = shape_dvec3_make(0, s->ground, 0);
        s->radius = 1;
        return;
    }
    shape_dvec3 a = {low[0], low[1], low[2]}, b = {high[0], high[1], high[2]};
    s->middle = shape_dvec3_scale(shape_dvec3_add(a, b), 0.5);
    s->radius = (float)fmax(shape_dvec3_length(shape_dvec3_sub(b, a)) / 2, 1e-6);
}

static void put_triangle(float *to, const shape_opaque_triangle *t, shape_dvec3 middle)
{
    shape_dvec3 one = shape_dvec3_sub(t->corner[1], t->corner[0]),
                two = shape_dvec3_sub(t->corner[2], t->corner[0]);
    shape_dvec3 normal = shape_dvec3_normalize(shape_dvec3_cross(one, two));
    double away = shape_dvec3_dot(normal, shape_dvec3_sub(t->corner[0], middle));
    for (int k = 0; k < 3; k++, to += VERTEX_FLOATS) {
        shape_dvec3 p = shape_dvec3_sub(t->corner[k], middle);
        const double values[7] = {p.x, p.y, p.z, normal.x, normal.y, normal.z, away};
        for (int i = 0; i < 7; i++)
            to[i] = (float)values[i];
        memcpy(to + 7, t->albedo, 3 * sizeof *to);
    }
}

static shape_status upload(gl_surface *s, const shape_opaque *opaque, shape_error *error)
{
    enum { TRIANGLE = 3 * VERTEX_FLOATS };
    size_t count = (size_t)s->solid_count;
    float *all = malloc((count + 1) * TRIANGLE * sizeof *all), *to = all;
    if (!all)
        return shape_error_memory(error);
    for (size_t i = 0; i < shape_opaque_triangle_count(opaque); i++) {
        shape_opaque_triangle t = shape_opaque_get_triangle(opaque, i);
        if (t.ground)
            continue;
        put_triangle(to, &t, s->middle);
        to += TRIANGLE;
    }
    glGenVertexArrays(1, &s->array);
    glGenBuffers(1, &s->buffer);
    glBindVertexArray(s->array);
    glBindBuffer(GL_ARRAY_BUFFER, s->buffer);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * TRIANGLE * sizeof *all), all, GL_STATIC_DRAW);
    free(all);
    static const int sizes[] = {3, 4, 3};
    for (GLuint i = 0, at = 0; i < 3; at += (GLuint)sizes[i++]) {
        glEnableVertexAttribArray(i);
        glVertexAttribPointer(i, sizes[i], GL_FLOAT, GL_FALSE, VERTEX_FLOATS * sizeof(float),
                              (const void *)(uintptr_t)(at * sizeof(float)));
    }
    if (glGetError() == GL_OUT_OF_MEMORY)
        return shape_error_set(error, SHAPE_ERROR_MEMORY,
                               "the GPU has not enough memory for %zu triangles (decimate the meshes)",
                               count);
    return SHAPE_OK;
}

static void make_map(gl_surface *s)
{
    static const float outside[] = {1, 1, 1, 1};
    glGenTextures(1, &s->map);
    glBindTexture(GL_TEXTURE_2D, s->map);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, MAP_SIDE, MAP_SIDE, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                 NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, outside);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glGenFramebuffers(1, &s->map_framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, s->map_framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, s->map, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
}

shape_status gl_surface_load(shape_gl_renderer *r, shape_error *error)
{
    gl_surface *s = &r->surface;
    const shape_opaque *opaque = r->options.light.opaque;
    size_t count = shape_opaque_triangle_count(opaque);
    if (!count || s->count)
        return SHAPE_OK;
    const char *folder = r->options.shader_folder;
    shape_status status =
        gl_program_create(folder, "view/surface.vert", "view/surface.frag", "", &s->program, error);
    if (!status)
        status = gl_program_create(folder, "view/surface_shadow.vert", "view/surface_shadow.frag", "",
                                   &s->shadow_program, error);
    if (status)
        return status;
    find_extent(s, opaque);
    s->count = (int)count;
    make_map(s);
    glGenTextures(1, &s->clouds);
    glBindTexture(GL_TEXTURE_2D, s->clouds);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return upload(s, opaque, error);
}

shape_status gl_surface_resize(gl_surface *s, int width, int height, shape_error *error)
{
    return s->count ? gl_target_make(&s->picture, width, height, true, error) : SHAPE_OK;
}

void gl_surface_free(gl_surface *s)
{
    glDeleteProgram(s->program);
    glDeleteProgram(s->shadow_program);
    glDeleteVertexArrays(1, &s->array);
    glDeleteBuffers(1, &s->buffer);
    glDeleteTextures(1, &s->map);
    glDeleteFramebuffers(1, &s->map_framebuffer);
    glDeleteTextures(1, &s->clouds);
    gl_target_free(&s->picture);
    memset(s, 0, sizeof *s);
}

/* --- passes --- */

/* Two unit vectors across the sun's direction. */
static void across(shape_dvec3 sun, shape_dvec3 *right, shape_dvec3 *up)
{
    shape_dvec3 any = fabs(sun.y) < 0.9 ? shape_dvec3_make(0, 1, 0) : shape_dvec3_make(1, 0, 0);
    *right = shape_dvec3_normalize(shape_dvec3_cross(any, sun));
    *up = shape_dvec3_cross(sun, *right);
}

static void set_sun(const shape_gl_renderer *r, GLuint program)
{
    shape_dvec3 right, up;
    across(r->light.sun, &right, &up);
    gl_set_dvector(program, "map_right", right);
    gl_set_dvector(program, "map_up", up);
    gl_set_dvector(program, "sun_direction", r->light.sun);
    gl_set_float(program, "map_radius", r->surface.radius * 1.01f);
}

/* What the sun sees of the things; the ground throws no shadow on what stands above it. */
static void draw_map(const shape_gl_renderer *r)
{
    const gl_surface *s = &r->surface;
    static const float far = 1;
    glBindFramebuffer(GL_FRAMEBUFFER, s->map_framebuffer);
    glViewport(0, 0, MAP_SIDE, MAP_SIDE);
    glClearBufferfv(GL_DEPTH, 0, &far);
    glUseProgram(s->shadow_program);
    set_sun(r, s->shadow_program);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glBindVertexArray(s->array);
    glDrawArrays(GL_TRIANGLES, 0, 3 * s->solid_count);
    glDisable(GL_DEPTH_TEST);
}

void gl_set_things(const shape_gl_renderer *r, GLuint program, shape_dvec3 eye)
{
    const gl_surface *s = &r->surface;
    set_sun(r, program);
    gl_bind(program, "sun_map", 7, GL_TEXTURE_2D, s->map);
    gl_set_dvector(program, "middle", shape_dvec3_sub(s->middle, eye));
    gl_set_int(program, "has_ground", s->has_ground);
    gl_set_float(program, "ground", (float)(s->ground - eye.y));
}

void gl_surface_draw(shape_gl_renderer *r, const gl_frame *frame)
{
    gl_surface *s = &r->surface;
    static const float nothing[] = {0, 0, 0, 1e30f}, no_work[] = {0, 0, 0, 0}, far = 1;
    if (!s->count)
        return;
    if (!s->mapped)
        draw_map(r);
    s->mapped = true;
    shape_dvec3 eye = frame->camera->origin;
    GLuint program = s->program;
    glUseProgram(program);
    glBindFramebuffer(GL_FRAMEBUFFER, s->picture.framebuffer);
    glViewport(0, 0, frame->part->width, frame->part->height);
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClearBufferfv(GL_COLOR, 1, no_work);
    glClearBufferfv(GL_DEPTH, 0, &far);
    gl_set_light(r, program);
    if (!gl_law_has_sky(gl_law(r))) {
        gl_set_vector(program, "sky_upper", nothing);
        gl_set_vector(program, "sky_lower", nothing);
    }
    gl_set_camera(frame, program);
    gl_shade_set(r, program, s->clouds, eye, NULL); /* without memory: no shadow of clouds on things */
    gl_set_things(r, program, eye); /* after it, which binds textures to whatever unit is active */
    gl_set_vector(program, "ground_colour", s->ground_colour);
    glUniform2f(glGetUniformLocation(program, "ground_middle"), (float)-eye.x, (float)-eye.z);
    gl_set_float(program, "ground_reach", (float)(SHAPE_OPAQUE_GROUND_SIDE / 2));
    gl_set_int(program, "is_ground", 0);
    glUniform2f(glGetUniformLocation(program, "part_size"), (float)frame->part->width,
                (float)frame->part->height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glBindVertexArray(s->array);
    glDrawArrays(GL_TRIANGLES, 0, 3 * s->solid_count);
    if (s->has_ground) {
        gl_set_int(program, "is_ground", 1);
        gl_draw_triangle(r);
    }
    glDisable(GL_DEPTH_TEST);
}

void gl_set_surface(const shape_gl_renderer *r, GLuint program)
{
    gl_bind(program, "surface", 8, GL_TEXTURE_2D, r->surface.picture.textures[0]);
    gl_set_int(program, "surface_on", r->surface.count > 0);
}
