/* The passes: light (on the CPU), view, accumulation, tone mapping. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "gl_private.h"

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

shape_gl_options shape_gl_defaults(void)
{
    shape_gl_options options = {
        .method = SHAPE_GL_DEFAULT, .light = shape_lightgrid_defaults(), .bake_voxels = 12000000, .seed = 1};
    options.lighting.powder = 2;
    options.lighting.octaves = 8;
    return options;
}

/* Whether a sample is drawn in parts: only the exact view walks trees and may take long for a pixel. */
static bool in_parts(const shape_gl_renderer *renderer)
{
    return renderer->options.method == SHAPE_GL_EXACT;
}

/* Makes the programs anew where they are for other air, or another law of light. */
static shape_status make_programs(shape_gl_renderer *renderer, shape_error *error)
{
    bool air = gl_has_air(renderer);
    int wanted = 2 + air + 2 * (int)gl_law(renderer), made_for = renderer->made_for;
    if (wanted == made_for)
        return SHAPE_OK;
    renderer->made_for = 0;
    shape_status status = SHAPE_OK;
    if (renderer->options.method == SHAPE_GL_DEFAULT) {
        gl_preview_drop_programs(&renderer->preview, made_for && made_for % 2 == wanted % 2);
        if (!renderer->options.early)
            status = gl_preview_compile(renderer, GL_PREVIEW_PROGRAMS, error);
    } else if (renderer->volume) {
        status = gl_prepare_view(renderer, error);
    }
    if (!status)
        renderer->made_for = wanted;
    return status;
}

shape_status shape_gl_create(const shape_gl_options *options, shape_gl_renderer **renderer,
                             shape_error *error)
{
    shape_gl_renderer *made = calloc(1, sizeof *made);
    if (!made)
        return shape_error_memory(error);
    made->options = *options;
    const char *folder = options->shader_folder;
    static const char whole[] = "view/fullscreen.vert";
    if (options->method != SHAPE_GL_DEFAULT || folder)
        made->options.early = false;
    shape_status status = SHAPE_OK;
    if (options->method == SHAPE_GL_DEFAULT)
        status = make_programs(made, error);
    if (!status && !made->options.early)
        status = gl_program_create(folder, whole, "view/tonemap.frag", "", &made->tonemap, error);
    if (!status && in_parts(made))
        status = gl_program_create(folder, whole, "view/copy.frag", "", &made->copy, error);
    if (status) {
        shape_gl_destroy(made);
        return status;
    }
    glGenVertexArrays(1, &made->empty_array);
    glGenQueries(1, &made->query);
    *renderer = made;
    return SHAPE_OK;
}

void shape_gl_destroy(shape_gl_renderer *renderer)
{
    if (!renderer)
        return;
    gl_refine_stop(renderer);
    shape_gl_first_free(renderer->first);
    gl_update_free(&renderer->update);
    gl_light_drop(renderer->earlier);
    gl_scene_free(&renderer->scene);
    gl_grids_drop(&renderer->grids);
    gl_grids_drop(&renderer->last_grids);
    gl_pool_free(&renderer->pool);
    gl_preview_free(&renderer->preview);
    gl_surface_free(&renderer->surface);
    glDeleteProgram(renderer->view_programs[0]);
    glDeleteProgram(renderer->view_programs[1]);
    gl_air_free(&renderer->air);
    glDeleteProgram(renderer->tonemap);
    glDeleteProgram(renderer->density);
    glDeleteProgram(renderer->copy);
    glDeleteProgram(renderer->heat);
    glDeleteQueries(1, &renderer->query);
    gl_target_free(&renderer->mean);
    gl_target_free(&renderer->parts[0]);
    gl_target_free(&renderer->parts[1]);
    glDeleteVertexArrays(1, &renderer->empty_array);
    free(renderer);
}

/* A window that few of very many primitives begin in, if they lie evenly; see shaders/field/interval.glsl. */
static float window_length(const shape_volume *volume)
{
    enum { MANY = 2000, IN_A_WINDOW = 16 };
    double extent = 0, count = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        shape_dvec3 min, max;
        shape_frame_box(&volume->clouds[i].frame, volume->clouds[i].box, &min, &max);
        extent = fmax(extent, shape_dvec3_length(shape_dvec3_sub(max, min)));
        count += (double)shape_primitives_count(volume->clouds[i].list);
    }
    return count > MANY ? (float)(extent * IN_A_WINDOW / count) : 1e30f;
}

shape_status shape_gl_load(shape_gl_renderer *renderer, const shape_volume *volume, shape_error *error)
{
    double start = now_ms();
    bool stays = gl_update_begin(renderer, volume);
    gl_refine_stop(renderer);
    gl_light_drop(renderer->earlier);
    renderer->earlier = NULL;
    gl_grids_drop(&renderer->last_grids);
    if (!stays) {
        gl_grids_drop(&renderer->grids);
        gl_pool_free(&renderer->pool);
    }
    renderer->fade_left = 0;
    renderer->volume = volume;
    renderer->window_length = window_length(volume);
    for (size_t i = 0; i < volume->cloud_count; i++)
        if (gl_is_paper(renderer) && volume->clouds[i].field.model == SHAPE_MODEL_GRID)
            return shape_error_set(
                error, SHAPE_ERROR_ARGUMENT,
                "the paper's methods draw primitives, not voxel grids (choose another --method)");
    shape_status status = gl_prepare_view(renderer, error);
    if (!status)
        status = gl_scene_load(&renderer->scene, volume, error);
    if (!status && renderer->options.method != SHAPE_GL_DEFAULT)
        gl_scene_load_noise(&renderer->scene, volume->noise);
    if (!status && renderer->options.method == SHAPE_GL_EXACT)
        status = gl_volumes_load(&renderer->scene, volume, error);
    if (!status && !gl_is_paper(renderer))
        status = gl_surface_load(renderer, error);
    renderer->costs.upload_ms = now_ms() - start;
    return status;
}

shape_status shape_gl_light(shape_gl_renderer *renderer, const shape_light *light, shape_error *error)
{
    const shape_dvec3 *old = &renderer->light.sun, *sun = &light->sun;
    if (old->x != sun->x || old->y != sun->y || old->z != sun->z || !renderer->grids.light ||
        light->sky != renderer->light.sky) /* a clear sky's light comes from its bright parts */
        renderer->light_changed = true;
    renderer->surface.mapped = false;
    renderer->light = *light;
    renderer->sky = shape_sky_make(light);
    shape_sky_mean(&renderer->sky, renderer->sky_upper, renderer->sky_lower);
    return make_programs(renderer, error);
}

shape_status shape_gl_set_lighting(shape_gl_renderer *r, const shape_gl_lighting *lighting,
                                   shape_error *error)
{
    shape_status status = gl_law_check(lighting, error);
    if (status)
        return status;
    bool grid = gl_law(r) == SHAPE_GL_LAW_GRID;
    r->options.lighting = *lighting;
    if ((gl_law(r) == SHAPE_GL_LAW_GRID) != grid)
        r->light_changed = true; /* scattered light is solved for the grid alone */
    return make_programs(r, error);
}

int shape_gl_largest(void)
{
    GLint largest = 2048;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    return largest > SHAPE_GL_PART_STEP ? (int)largest : SHAPE_GL_PART_STEP;
}

void shape_gl_set_part(shape_gl_renderer *renderer, shape_gl_part part)
{
    renderer->part = part;
}

/* The buffers that pictures are drawn into, remade where the size changes. */
static shape_status prepare_targets(shape_gl_renderer *renderer, int width, int height, shape_error *error)
{
    if (renderer->mean.framebuffer && renderer->width == width && renderer->height == height)
        return SHAPE_OK;
    int largest = shape_gl_largest();
    if (width > largest || height > largest)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "a picture of %dx%d is larger than this GPU draws (%dx%d)", width, height,
                               largest, largest);
    static const float nothing[4];
    shape_status status = gl_target_make(&renderer->mean, width, height, true, error);
    /* What is drawn first is blended with it, though it counts nothing; what is painted is not. */
    for (int i = 0; i < 2 && !status && !renderer->early; i++)
        glClearBufferfv(GL_COLOR, i, nothing);
    if (!status && renderer->options.method == SHAPE_GL_DEFAULT)
        status = gl_preview_resize(&renderer->preview, width, height, error);
    if (!status)
        status = gl_surface_resize(&renderer->surface, width, height, error);
    for (int i = 0; i < 2 && !status && in_parts(renderer); i++)
        status = gl_target_make(&renderer->parts[i], width, height, false, error);
    renderer->width = width;
    renderer->height = height;
    return status;
}

/* A sample of the other methods: one program over the whole picture. */
static shape_status draw_whole(shape_gl_renderer *renderer, const gl_frame *frame, shape_error *error)
{
    GLuint program;
    if (in_parts(renderer))
        return gl_draw_in_parts(renderer, frame, error);
    shape_status status = gl_use_view(renderer, frame, false, &program, error);
    if (status)
        return status;
    glBindFramebuffer(GL_FRAMEBUFFER, renderer->mean.framebuffer);
    gl_begin_mean(frame->sample);
    gl_draw_triangle(renderer);
    glDisable(GL_BLEND);
    return SHAPE_OK;
}

/* Whether moving pictures are still drawn without shaders. */
static bool is_early(const shape_gl_renderer *r)
{
    return r->options.early && !r->options.light.opaque && !gl_has_air(r) && gl_law(r) == SHAPE_GL_LAW_GRID &&
           r->preview.warm < gl_preview_needed(r);
}

/* The first picture at once; with each of the next ones a shader is made ready. */
static shape_status draw_early(shape_gl_renderer *renderer, const gl_grids *grids, const gl_frame *frame,
                               shape_error *error)
{
    shape_status status = SHAPE_OK;
    if (renderer->early_drawn)
        status = gl_preview_warm(renderer, grids, frame, error);
    renderer->early_drawn = true;
    return status ? status : gl_early_draw(renderer, grids, frame, error);
}

/* The preview by one set of grids. */
static shape_status draw_by(shape_gl_renderer *renderer, gl_grids *grids, gl_frame *frame, shape_error *error)
{
    gl_light_place(grids->light, &renderer->scene, renderer->volume);
    if (grids->baked)
        gl_baked_place(grids->baked, &renderer->scene);
    if (gl_law(renderer) != SHAPE_GL_LAW_GRID) {
        gl_light_upload_depths(grids->light, renderer);
        gl_law_place(renderer, &renderer->scene);
    }
    gl_scene_place_eye(&renderer->scene, renderer->volume, frame->camera);
    shape_status status = SHAPE_OK;
    if (frame->sample == 0 && !gl_is_paper(renderer) && gl_law(renderer) == SHAPE_GL_LAW_GRID)
        status = gl_light_compose(grids->light, renderer, frame->camera->origin, error);
    if (status)
        return status;
    if (renderer->options.method != SHAPE_GL_DEFAULT)
        return draw_whole(renderer, frame, error);
    if (renderer->early)
        return draw_early(renderer, grids, frame, error);
    status = gl_preview_compile(renderer, frame->moving ? gl_preview_needed(renderer) : GL_PREVIEW_PROGRAMS,
                                error);
    if (status)
        return status;
    gl_preview_draw(renderer, grids, frame);
    return SHAPE_OK;
}

static shape_status draw(shape_gl_renderer *renderer, const shape_view *view, int sample, bool moving,
                         shape_error *error)
{
    const shape_gl_part whole = {0, 0, view->width, view->height};
    const shape_gl_part *part = renderer->part.width ? &renderer->part : &whole;
    renderer->early = moving && is_early(renderer);
    shape_status status = prepare_targets(renderer, part->width, part->height, error);
    if (!moving)
        renderer->fade_left = 0; /* a picture at rest is of the last grids alone */
    if (!status)
        status = gl_refine_send(renderer, error);
    if (!status)
        status = gl_refine(renderer, view, error);
    if (status)
        return status;
    shape_camera camera = shape_view_camera(view);
    gl_tiles tiles;
    gl_frame frame = {view, &camera, &tiles, part, sample, moving, !renderer->early_drawn, 1};
    gl_scene_place_eye(&renderer->scene, renderer->volume, &camera); /* finds what is in sight */
    status = gl_tiles_make(&tiles, &renderer->scene, renderer->volume, view, part, &camera, error);
    if (!status && renderer->options.method == SHAPE_GL_EXACT)
        status = gl_tiles_list_primitives(&tiles, renderer->volume, view, part, &camera, error);
    if (!status) {
        gl_light_place(renderer->grids.light, &renderer->scene, renderer->volume);
        gl_surface_draw(renderer, &frame);
        status = gl_air_draw(renderer, &frame, error);
    }
    if (!status && moving && renderer->fade_left > 0) {
        status = draw_by(renderer, &renderer->last_grids, &frame, error);
        frame.share = 1 - (float)renderer->fade_left / (GL_FADE_FRAMES + 1);
        renderer->fade_left--;
    }
    if (!status)
        status = draw_by(renderer, &renderer->grids, &frame, error);
    gl_tiles_free(&tiles);
    if (renderer->fade_left == 0)
        gl_grids_drop(&renderer->last_grids);
    if (!status && glGetError() == GL_OUT_OF_MEMORY)
        return shape_error_set(error, SHAPE_ERROR_MEMORY,
                               "the GPU has not enough memory (make the picture smaller)");
    return status;
}

shape_status shape_gl_draw(shape_gl_renderer *renderer, const shape_view *view, int sample,
                           shape_error *error)
{
    return draw(renderer, view, sample, false, error);
}

shape_status shape_gl_draw_moving(shape_gl_renderer *renderer, const shape_view *view, shape_error *error)
{
    return draw(renderer, view, 0, true, error);
}

bool shape_gl_refined(shape_gl_renderer *renderer)
{
    bool refined = renderer->refined;
    renderer->refined = false;
    return refined;
}

bool shape_gl_pending(const shape_gl_renderer *renderer)
{
    return renderer->refinement || renderer->coming.light || renderer->coming.baked ||
           renderer->fade_left > 0 || is_early(renderer);
}

void shape_gl_finish(void)
{
    glFinish();
}

shape_status shape_gl_densities(shape_gl_renderer *renderer, const shape_vec3 *points, int count, float *rgba,
                                shape_error *error)
{
    enum { WIDTH = 2048 };
    shape_status status = SHAPE_OK;
    if (!renderer->density)
        status = gl_program_create(renderer->options.shader_folder, "view/fullscreen.vert",
                                   "view/density.frag", "", &renderer->density, error);
    int rows = (count + WIDTH - 1) / WIDTH;
    float *texels = calloc((size_t)rows * WIDTH * 4, sizeof *texels);
    if (!texels)
        return shape_error_memory(error);
    for (int i = 0; i < count; i++)
        memcpy(texels + 4 * i, &points[i], sizeof points[i]);
    if (!status)
        status = prepare_targets(renderer, WIDTH, rows, error);
    if (!status) {
        GLuint texture = gl_float_texture(texels, (size_t)rows * WIDTH, &status, error);
        shape_view view = shape_view_defaults();
        view.eye = shape_dvec3_make(0, 0, 0);
        /* A camera that sees everything: the records are wanted, not the view. */
        shape_camera camera = {view.eye, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        camera.right = camera.up = shape_dvec3_make(0, 0, 0);
        gl_scene_load_noise(&renderer->scene, renderer->volume->noise);
        glUseProgram(renderer->density);
        glBindFramebuffer(GL_FRAMEBUFFER, renderer->mean.framebuffer);
        glViewport(0, 0, WIDTH, rows);
        gl_scene_place_eye(&renderer->scene, renderer->volume, &camera);
        gl_set_scene(&renderer->scene, renderer->density);
        gl_bind(renderer->density, "points", 8, GL_TEXTURE_2D, texture);
        glDisable(GL_BLEND);
        glBindVertexArray(renderer->empty_array);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        glReadBuffer(GL_COLOR_ATTACHMENT0);
        glReadPixels(0, 0, WIDTH, rows, GL_RGBA, GL_FLOAT, texels);
        glDeleteTextures(1, &texture);
        memcpy(rgba, texels, (size_t)count * 4 * sizeof *rgba);
    }
    free(texels);
    return status;
}
