/* A scene in memory: made, filled, destroyed. */
#include "shape/scene.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

shape_scene *shape_scene_create(shape_error *error)
{
    shape_scene *scene = calloc(1, sizeof *scene);
    if (!scene)
        shape_error_memory(error);
    return scene;
}

static void free_options(shape_scene_options *options)
{
    for (size_t i = 0; i < options->count; i++) {
        free(options->items[i].name);
        free(options->items[i].text);
    }
    free(options->items);
}

void shape_scene_clear_options(shape_scene_options *options)
{
    free_options(options);
    memset(options, 0, sizeof *options);
}

void shape_scene_clear_edits(shape_scene *scene)
{
    for (size_t i = 0; i < scene->edit_count; i++) {
        free(scene->edits[i].note);
        free(scene->edits[i].cloud);
        free_options(&scene->edits[i].medium);
    }
    free(scene->edits);
    scene->edits = NULL;
    scene->edit_count = scene->edit_capacity = 0;
}

void shape_scene_destroy(shape_scene *scene)
{
    if (!scene)
        return;
    for (size_t i = 0; i < scene->cloud_count; i++) {
        shape_scene_cloud *cloud = &scene->clouds[i];
        free(cloud->name);
        free(cloud->note);
        free(cloud->file);
        free(cloud->generator);
        free(cloud->input);
        free(cloud->copies);
        free_options(&cloud->options);
        free_options(&cloud->medium);
    }
    for (size_t i = 0; i < scene->mesh_count; i++) {
        free(scene->meshes[i].note);
        free(scene->meshes[i].file);
    }
    shape_scene_clear_edits(scene);
    free_options(&scene->medium);
    free_options(&scene->view);
    free(scene->compare);
    free(scene->meshes);
    free(scene->clouds);
    free(scene->note);
    free(scene);
}

shape_status shape_scene_add_cloud(shape_scene *scene, shape_scene_cloud **cloud, shape_error *error)
{
    shape_status status = shape_array_reserve((void **)&scene->clouds, &scene->cloud_capacity,
                                              scene->cloud_count + 1, sizeof *scene->clouds, error);
    if (status)
        return status;
    *cloud = &scene->clouds[scene->cloud_count++];
    memset(*cloud, 0, sizeof **cloud);
    (*cloud)->place = shape_transform_defaults();
    return SHAPE_OK;
}

shape_status shape_scene_add_mesh(shape_scene *scene, shape_scene_mesh **mesh, shape_error *error)
{
    shape_status status = shape_array_reserve((void **)&scene->meshes, &scene->mesh_capacity,
                                              scene->mesh_count + 1, sizeof *scene->meshes, error);
    if (status)
        return status;
    *mesh = &scene->meshes[scene->mesh_count++];
    memset(*mesh, 0, sizeof **mesh);
    (*mesh)->unit = 1;
    (*mesh)->albedo[0] = (*mesh)->albedo[1] = (*mesh)->albedo[2] = 0.5;
    (*mesh)->place = shape_transform_defaults();
    return SHAPE_OK;
}

shape_status shape_scene_add_edit(shape_scene *scene, const char *cloud, shape_scene_edit **edit,
                                  shape_error *error)
{
    shape_status status = shape_array_reserve((void **)&scene->edits, &scene->edit_capacity,
                                              scene->edit_count + 1, sizeof *scene->edits, error);
    if (status)
        return status;
    shape_scene_edit *made = &scene->edits[scene->edit_count];
    memset(made, 0, sizeof *made);
    made->scale = 1;
    if (cloud)
        status = shape_scene_set_text(&made->cloud, cloud, error);
    if (status)
        return status;
    scene->edit_count++;
    *edit = made;
    return SHAPE_OK;
}

const char *shape_scene_find_option(const shape_scene_options *options, const char *name)
{
    for (size_t i = 0; i < options->count; i++)
        if (!strcmp(options->items[i].name, name))
            return options->items[i].text;
    return NULL;
}

shape_frame shape_scene_mesh_frame(const shape_scene_mesh *mesh, bool z_up)
{
    double s = mesh->unit;
    shape_frame place = shape_transform_frame(&mesh->place);
    if (mesh->up != SHAPE_SCENE_UP_FORMAT)
        z_up = mesh->up == SHAPE_SCENE_UP_Z;
    shape_frame file = {{{s, 0, 0, 0}, {0, s, 0, 0}, {0, 0, s, 0}}};
    shape_frame turned = {{{s, 0, 0, 0}, {0, 0, s, 0}, {0, -s, 0, 0}}};
    return shape_frame_multiply(&place, z_up ? &turned : &file);
}

shape_status shape_scene_add_copy(shape_scene_cloud *cloud, const shape_transform *place, shape_error *error)
{
    shape_status status = shape_array_reserve((void **)&cloud->copies, &cloud->copy_capacity,
                                              cloud->copy_count + 1, sizeof *cloud->copies, error);
    if (!status)
        cloud->copies[cloud->copy_count++] = *place;
    return status;
}

shape_status shape_scene_set_text(char **member, const char *text, shape_error *error)
{
    char *copy = malloc(strlen(text) + 1);
    if (!copy)
        return shape_error_memory(error);
    memcpy(copy, text, strlen(text) + 1);
    free(*member);
    *member = copy;
    return SHAPE_OK;
}

shape_status shape_scene_add_option(shape_scene_options *options, const char *name, const char *text,
                                    shape_error *error)
{
    shape_scene_option option = {0};
    shape_status status = shape_array_reserve((void **)&options->items, &options->capacity,
                                              options->count + 1, sizeof *options->items, error);
    if (!status)
        status = shape_scene_set_text(&option.name, name, error);
    if (!status && text)
        status = shape_scene_set_text(&option.text, text, error);
    if (status)
        free(option.name);
    else
        options->items[options->count++] = option;
    return status;
}

bool shape_scene_is(const void *bytes, size_t size)
{
    const unsigned char *c = bytes;
    if (shape_scene_is_picture(bytes, size))
        return true;
    while (size && strchr(" \t\r\n", *c) && *c) {
        c++;
        size--;
    }
    return size && *c == '{';
}
