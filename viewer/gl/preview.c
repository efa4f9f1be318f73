/* The default method's passes: tiles without a cloud, with one, and with several each have a shader of their own, since
 * a shader that can do all pays for all in every pixel. A moving view is marched at every second pixel each way first;
 * the others are filled from these where they agree, and marched where they do not. */
#include <string.h>

#include "gl_private.h"

enum { SKY_SPACING = 8 }; /* as in shaders/view/sky_picture.glsl */

/* How far a pixel's neighbours may differ, in transmittance or relative brightness, for it to be their mean. */
static const float AGREEMENT = 0.1f;

shape_status gl_preview_create(gl_preview *preview, const char *folder, const char *defines, bool marching,
                               shape_error *error)
{
    const struct {
        const char *vertex, *fragment;
        GLuint *program;
        bool marches;
    } programs[] = {{"view/tile.vert", "view/preview_sky.frag", &preview->sky, false},
                    {"view/tile.vert", "view/preview_one.frag", &preview->one, true},
                    {"view/tile.vert", "view/preview.frag", &preview->several, true},
                    {"view/fullscreen.vert", "view/preview_fill.frag", &preview->fill, false},
                    {"view/fullscreen.vert", "view/sky.frag", &preview->sky_picture_program, false}};
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < sizeof programs / sizeof *programs && !status; i++) {
        if (marching && !programs[i].marches)
            continue;
        glDeleteProgram(*programs[i].program);
        *programs[i].program = 0;
        status = gl_program_create(folder, programs[i].vertex, programs[i].fragment, defines,
                                   programs[i].program, error);
    }
    return status;
}

void gl_preview_free(gl_preview *preview)
{
    const GLuint programs[] = {preview->sky, preview->one, preview->several, preview->fill,
                               preview->sky_picture_program};
    for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
        glDeleteProgram(programs[i]);
    gl_target_free(&preview->coarse);
    gl_target_free(&preview->sky_picture);
    memset(preview, 0, sizeof *preview);
}

shape_status gl_preview_resize(gl_preview *preview, int width, int height, shape_error *error)
{
    shape_status status = gl_target_make(&preview->coarse, (width + 1) / 2, (height + 1) / 2, false, error);
    if (!status)
        status = gl_target_make(&preview->sky_picture, width / SKY_SPACING + 2, height / SKY_SPACING + 2,
                                false, error);
    if (!status) {
        glBindTexture(GL_TEXTURE_2D, preview->sky_picture.textures[0]);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    }
    return status;
}

/* The sky behind the picture that is to be drawn. */
static void draw_sky_picture(const shape_gl_renderer *r, const gl_frame *frame)
{
    GLuint program = r->preview.sky_picture_program;
    glUseProgram(program);
    glBindFramebuffer(GL_FRAMEBUFFER, r->preview.sky_picture.framebuffer);
    glViewport(0, 0, r->width / SKY_SPACING + 2, r->height / SKY_SPACING + 2);
    gl_set_light(r, program);
    if (gl_has_air(r)) /* it lights the air even where it is not seen */
        gl_set_int(program, "sky_kind", (int)r->sky.kind);
    gl_set_camera(frame, program);
    gl_draw_triangle(r);
}

/* A frame by one set of grids. */
typedef struct gl_pass {
    const gl_frame *frame;
    const gl_grids *grids;
} gl_pass;

/* What all of the preview's programs may ask for. */
static void set_all(const shape_gl_renderer *r, const gl_pass *pass, GLuint program, int stride)
{
    glUseProgram(program);
    gl_set_scene(&r->scene, program);
    gl_set_grids(pass->grids, program);
    gl_set_law(r, pass->grids, program);
    gl_set_tiles(pass->frame->tiles, program);
    gl_set_camera(pass->frame, program);
    gl_set_method(r, pass->frame->view, program);
    gl_set_surface(r, program);
    gl_set_air(r, program, pass->frame->camera->origin);
    gl_bind(program, "sky_picture", 14, GL_TEXTURE_2D, r->preview.sky_picture.textures[0]);
    gl_set_float(program, "pixel_stride", (float)stride);
    gl_set_float(program, "step_deep", pass->frame->moving ? 2.0f : 0.0f);
    glUniform2f(glGetUniformLocation(program, "target_size"), (float)((r->width + stride - 1) / stride),
                (float)((r->height + stride - 1) / stride));
}

/* Draws `count` tiles of the list from `first` on. */
static void draw_tiles(const shape_gl_renderer *r, const gl_pass *pass, GLuint program, int stride, int first,
                       int count)
{
    if (!count)
        return;
    set_all(r, pass, program, stride);
    gl_set_int(program, "tile_first", first);
    glBindVertexArray(r->empty_array);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
}

static void draw_clouds(const shape_gl_renderer *r, const gl_pass *pass, int stride)
{
    const gl_tiles *tiles = pass->frame->tiles;
    draw_tiles(r, pass, r->preview.one, stride, tiles->empty_count, tiles->one_count);
    draw_tiles(r, pass, r->preview.several, stride, tiles->empty_count + tiles->one_count,
               tiles->several_count);
}

static void draw_moving(const shape_gl_renderer *r, const gl_pass *pass)
{
    static const float nothing[] = {0, 0, 0, 1}, no_work[] = {0, 0, 0, 0}, far = 1;
    glBindFramebuffer(GL_FRAMEBUFFER, r->preview.coarse.framebuffer);
    glViewport(0, 0, (r->width + 1) / 2, (r->height + 1) / 2);
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClearBufferfv(GL_COLOR, 1, no_work);
    draw_clouds(r, pass, 2);

    GLuint fill = r->preview.fill;
    glBindFramebuffer(GL_FRAMEBUFFER, r->mean.framebuffer);
    glViewport(0, 0, r->width, r->height);
    glClearBufferfv(GL_DEPTH, 0, &far);
    set_all(r, pass, fill, 1);
    gl_bind(fill, "coarse_picture", 12, GL_TEXTURE_2D, r->preview.coarse.textures[0]);
    gl_set_float(fill, "coarse_agreement", AGREEMENT);
    /* What is filled is marked by its depth; the marching passes the depth test elsewhere only. */
    gl_begin_mix(pass->frame->share);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    glDepthRange(0, 0);
    gl_draw_triangle(r);
    glDepthRange(0.5, 0.5);
    glDepthFunc(GL_LESS);
    draw_clouds(r, pass, 1);
    glDepthRange(0, 1);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
}

void gl_preview_draw(shape_gl_renderer *r, const gl_grids *grids, const gl_frame *frame)
{
    gl_pass pass = {frame, grids};
    draw_sky_picture(r, frame);
    r->preview.moving = frame->moving;
    if (frame->moving) {
        draw_moving(r, &pass);
        return;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, r->mean.framebuffer);
    glViewport(0, 0, r->width, r->height);
    gl_begin_mean(frame->sample);
    draw_tiles(r, &pass, r->preview.sky, 1, 0, frame->tiles->empty_count);
    draw_clouds(r, &pass, 1);
    glDisable(GL_BLEND);
}
