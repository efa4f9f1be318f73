/* The default method's passes: tiles without a cloud, with one, and with several each have a shader of their own, since
 * a shader that can do all pays for all in every pixel. A moving view is marched at every second pixel each way first;
 * the others are filled from these where they agree, and marched where they do not. */
#include <stdio.h>
#include <string.h>

#include "gl_private.h"

enum { SKY_SPACING = 8 }; /* as in shaders/view/sky_picture.glsl */

/* How far a pixel's neighbours may differ, in transmittance or relative brightness, for it to be their mean. */
static const float AGREEMENT = 0.2f;

/* Program number i, in the order in which they are compiled. */
static GLuint *program_number(gl_preview *preview, int i)
{
    GLuint *const programs[GL_PREVIEW_PROGRAMS] = {&preview->sky_picture_program, &preview->one,
                                                   &preview->fill, &preview->several, &preview->sky};
    return programs[i];
}

shape_status gl_preview_compile(shape_gl_renderer *r, int count, shape_error *error)
{
    static const struct {
        const char *vertex, *fragment;
    } sources[GL_PREVIEW_PROGRAMS] = {{"view/fullscreen.vert", "view/sky.frag"},
                                      {"view/tile.vert", "view/preview_one.frag"},
                                      {"view/fullscreen.vert", "view/preview_fill.frag"},
                                      {"view/tile.vert", "view/preview.frag"},
                                      {"view/tile.vert", "view/preview_sky.frag"}};
    char defines[64];
    snprintf(defines, sizeof defines, "%s", gl_has_air(r) ? "#define AIR\n" : "");
    gl_law_define(r, defines, sizeof defines);
    shape_status status = SHAPE_OK;
    for (int i = 0; i < count && !status; i++)
        if (!*program_number(&r->preview, i))
            status = gl_program_create(r->options.shader_folder, sources[i].vertex, sources[i].fragment,
                                       defines, program_number(&r->preview, i), error);
    return status;
}

int gl_preview_needed(const shape_gl_renderer *r)
{
    return r->volume->cloud_count > 1 ? GL_PREVIEW_PROGRAMS - 1 : GL_PREVIEW_PROGRAMS - 2;
}

void gl_preview_drop_programs(gl_preview *preview, bool marching)
{
    for (int i = 0; i < GL_PREVIEW_PROGRAMS; i++) {
        GLuint *program = program_number(preview, i);
        if (marching && program != &preview->one && program != &preview->several)
            continue;
        glDeleteProgram(*program);
        *program = 0;
    }
}

void gl_preview_free(gl_preview *preview)
{
    gl_preview_drop_programs(preview, false);
    gl_target_free(&preview->coarse);
    gl_target_free(&preview->sky_picture);
    memset(preview, 0, sizeof *preview);
}

shape_status gl_preview_resize(gl_preview *preview, int width, int height, shape_error *error)
{
    shape_status status = gl_target_make(&preview->coarse, (width + 1) / 2, (height + 1) / 2, true, error);
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
    if (pass->frame
            ->moving) { /* coarser steps than gl_set_method's: a still view's picture is 0.5 % from theirs */
        gl_set_float(program, "step_deep", 2);
        gl_set_float(program, "step_depth", 0.4f);
    } else {
        gl_set_float(program, "step_deep", 0);
    }
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

/* Everything is drawn into a picture with the same depth test and the same blending, where it would need neither too: Mesa's
 * llvmpipe compiles a shader anew for each kind of them. share: what counts of what is drawn. */
static void begin(const gl_target *target, int width, int height, float share)
{
    static const float far = 1;
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    glViewport(0, 0, width, height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthRange(0.5, 0.5);
    glClearBufferfv(GL_DEPTH, 0, &far);
    gl_begin_mix(share);
}

static void end(void)
{
    glDepthRange(0, 1);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
}

static void draw_coarse(const shape_gl_renderer *r, const gl_pass *pass)
{
    static const float nothing[] = {0, 0, 0, 1}, no_work[] = {0, 0, 0, 0};
    begin(&r->preview.coarse, (r->width + 1) / 2, (r->height + 1) / 2, 1);
    glClearBufferfv(GL_COLOR, 0, nothing);
    glClearBufferfv(GL_COLOR, 1, no_work);
    draw_clouds(r, pass, 2);
}

/* What is filled is marked by its depth; the marching passes the depth test elsewhere only. */
static void draw_fill(const shape_gl_renderer *r, const gl_pass *pass)
{
    GLuint fill = r->preview.fill;
    set_all(r, pass, fill, 1);
    gl_bind(fill, "coarse_picture", 12, GL_TEXTURE_2D, r->preview.coarse.textures[0]);
    gl_set_float(fill, "coarse_agreement", AGREEMENT);
    glDepthRange(0, 0);
    gl_draw_triangle(r);
    glDepthRange(0.5, 0.5);
}

static void draw_moving(const shape_gl_renderer *r, const gl_pass *pass)
{
    draw_coarse(r, pass);
    begin(&r->mean, r->width, r->height, pass->frame->share);
    draw_fill(r, pass);
    draw_clouds(r, pass, 1);
    end();
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
    begin(&r->mean, r->width, r->height, 1.0f / (float)(frame->sample + 1));
    draw_tiles(r, &pass, r->preview.sky, 1, 0, frame->tiles->empty_count);
    draw_clouds(r, &pass, 1);
    end();
}

shape_status gl_preview_warm(shape_gl_renderer *r, const gl_grids *grids, const gl_frame *frame,
                             shape_error *error)
{
    gl_preview *preview = &r->preview;
    gl_pass pass = {frame, grids};
    const int i = preview->warm;
    shape_status status = gl_preview_compile(r, i + 1, error);
    if (status)
        return status;
    glEnable(GL_SCISSOR_TEST); /* a pixel, which is drawn anew at once */
    glScissor(0, 0, 1, 1);
    if (i == 0) {
        draw_sky_picture(r, frame);
    } else {
        begin(&r->mean, r->width, r->height, 1);
        if (*program_number(preview, i) == preview->fill)
            draw_fill(r, &pass);
        else
            draw_tiles(r, &pass, *program_number(preview, i), 1, 0, 1);
        end();
    }
    glDisable(GL_SCISSOR_TEST);
    preview->warm++;
    return SHAPE_OK;
}
