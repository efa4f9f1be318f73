/* The scene of what is seen. */
#include "scene_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_scene.h"
#include "entry.h"
#include "setting.h"
#include "state_scene.h"

typedef struct writer {
    const view_scene_parts *parts;
    const char *target;
    bool outside;
    shape_scene *scene;
    shape_error *error;
} writer;

/* *file, as seen from the target's folder. */
static shape_status name_file(writer *w, const char *path, char **file)
{
    char *name;
    bool outside;
    shape_status status = shape_scene_relative(w->target, path, &name, &outside, w->error);
    if (status)
        return status;
    free(*file);
    *file = name;
    w->outside = w->outside || outside;
    return SHAPE_OK;
}

/* A file that the opened scene names. */
static shape_status rename_file(writer *w, char **file)
{
    char *path;
    if (!*file)
        return SHAPE_OK;
    shape_status status =
        shape_scene_find_file(w->parts->path, *file, cli_outside_allowed(), &path, w->error);
    if (status)
        return status;
    status = name_file(w, path, file);
    free(path);
    return status;
}

/* The opened scene once more, by its text. */
static shape_status copy_scene(writer *w)
{
    char *text;
    size_t size;
    shape_status status = shape_scene_encode(w->parts->scene, &text, &size, w->error);
    if (status)
        return status;
    status = shape_scene_decode(text, size, w->parts->path, &w->scene, w->error);
    free(text);
    for (size_t i = 0; !status && i < w->scene->cloud_count; i++) {
        status = rename_file(w, &w->scene->clouds[i].file);
        if (!status)
            status = rename_file(w, &w->scene->clouds[i].input);
    }
    for (size_t i = 0; !status && i < w->scene->mesh_count; i++)
        status = rename_file(w, &w->scene->meshes[i].file);
    const view_generator *g = &w->parts->state->generator;
    if (!status && view_entry_stands(w->parts->scene, g))
        status = view_entry_apply(w->scene, g, w->error);
    return status;
}

static shape_status add_settings(writer *w, shape_scene_cloud *cloud)
{
    const view_generator *g = &w->parts->state->generator;
    shape_status status = shape_scene_set_text(&cloud->generator, view_generator_program(g), w->error);
    return status ? status : view_setting_options(g, true, &cloud->options, w->error);
}

/* A scene of one file, or of what a generator makes. */
static shape_status make_scene(writer *w)
{
    shape_scene_cloud *cloud;
    const char *path = w->parts->path;
    if (w->parts->volume)
        return shape_error_set(w->error, SHAPE_ERROR_ARGUMENT,
                               "a scene holds no volume (make primitives of it by neph-vdb first)");
    if (!strcmp(path, "-"))
        return shape_error_set(w->error, SHAPE_ERROR_ARGUMENT,
                               "a scene cannot name standard input (open a file)");
    w->scene = shape_scene_create(w->error);
    if (!w->scene)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_scene_add_cloud(w->scene, &cloud, w->error);
    if (status)
        return status;
    if (w->parts->state->generator.which < 0)
        return name_file(w, path, &cloud->file);
    status = add_settings(w, cloud);
    return status || !path[0] ? status : name_file(w, path, &cloud->input);
}

/* --mesh and --ground. */
static shape_status add_things(writer *w)
{
    const view_more_things *more = w->parts->more;
    shape_status status = SHAPE_OK;
    for (size_t i = 0; more && more->list && i < more->list->mesh_count && !status; i++) {
        shape_scene_mesh *mesh;
        status = shape_scene_add_mesh(w->scene, &mesh, w->error);
        if (status)
            break;
        memcpy(mesh->albedo, more->list->meshes[i].albedo, sizeof mesh->albedo);
        status = name_file(w, more->list->meshes[i].file, &mesh->file);
    }
    if (!more || !more->has_ground)
        return status;
    w->scene->ground_given = true;
    w->scene->ground = more->height;
    for (int c = 0; c < 3; c++)
        w->scene->ground_albedo[c] = view_neat(more->ground_albedo[c]);
    return status;
}

static shape_status fill(writer *w)
{
    const view_scene_parts *p = w->parts;
    shape_status status = p->scene ? copy_scene(w) : make_scene(w);
    if (!status)
        status = add_things(w);
    if (!status)
        status = view_state_save(p->state, p->made, w->scene, w->error);
    if (status)
        return status;
    w->scene->size_given = true;
    memcpy(w->scene->size, p->size, sizeof p->size);
    free(w->scene->compare);
    w->scene->compare = NULL;
    return p->other && p->other[0] ? name_file(w, p->other, &w->scene->compare) : SHAPE_OK;
}

shape_status view_scene_text(const view_scene_parts *parts, const char *target, char **text, size_t *size,
                             bool *outside, shape_error *error)
{
    writer w = {.parts = parts, .target = target, .error = error};
    shape_status status = fill(&w);
    if (!status)
        status = shape_scene_encode(w.scene, text, size, error);
    shape_scene_destroy(w.scene);
    *outside = w.outside;
    return status;
}
