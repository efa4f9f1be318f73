/* A scene's entry as a generator: its options by the panel's rows, and back. Options that the panel has no row for (the
 * medium's, texts) stay as they are. */
#include "entry.h"

#include <stdlib.h>
#include <string.h>

#include "cli_scene.h"
#include "setting.h"

/* A digest of what an entry says (FNV-1a of 64 bits), for telling whether it is another now. */
static uint64_t add_text(uint64_t digest, const char *text)
{
    for (const char *c = text ? text : "\1"; *c; c++)
        digest = (digest ^ (unsigned char)*c) * 0x100000001b3u;
    return (digest ^ 0xff) * 0x100000001b3u;
}

static uint64_t digest_of(const shape_scene_cloud *cloud)
{
    uint64_t digest = add_text(0xcbf29ce484222325u, cloud->generator);
    digest = add_text(digest, cloud->input);
    for (size_t i = 0; i < cloud->options.count; i++) {
        digest = add_text(digest, cloud->options.items[i].name);
        digest = add_text(digest, cloud->options.items[i].text);
    }
    return digest;
}

static void take_options(view_generator *g, const shape_scene_options *options)
{
    for (size_t i = 0; i < options->count; i++) {
        const shape_scene_option *option = &options->items[i];
        view_setting_row row;
        int at = view_setting_find(g, option->name);
        if (!strcmp(option->name, "seed") && option->text)
            g->seed = strtoull(option->text, NULL, 10);
        if (at >= 0 && view_setting_get_row(g, at, &row))
            g->settings[at].given = view_setting_read(&row, option->text, &g->settings[at]);
    }
}

view_generator view_entry_generator(const shape_scene *scene)
{
    for (size_t i = 0; i < scene->cloud_count; i++) {
        const shape_scene_cloud *cloud = &scene->clouds[i];
        if (!cloud->generator)
            continue;
        view_generator g = view_generator_named(cloud->generator, 1);
        if (g.which < 0)
            continue;
        take_options(&g, &cloud->options);
        g.entry = (int)i + 1;
        g.digest = digest_of(cloud);
        return g;
    }
    return view_generator_none(1);
}

bool view_entry_stands(const shape_scene *scene, const view_generator *g)
{
    return g->entry > 0 && (size_t)g->entry <= scene->cloud_count && scene->clouds[g->entry - 1].generator &&
           digest_of(&scene->clouds[g->entry - 1]) == g->digest;
}

/* Options that are no rows; whether there was a seed is told. */
static shape_status keep_others(const view_generator *g, const shape_scene_options *from,
                                shape_scene_options *kept, bool *seeded, shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < from->count && !status; i++) {
        const shape_scene_option *option = &from->items[i];
        bool seed = !strcmp(option->name, "seed");
        *seeded = *seeded || seed;
        if (!seed && view_setting_find(g, option->name) < 0)
            status = shape_scene_add_option(kept, option->name, option->text, error);
    }
    return status;
}

shape_status view_entry_apply(shape_scene *scene, const view_generator *g, shape_error *error)
{
    shape_scene_options *options = &scene->clouds[g->entry - 1].options, kept = {0};
    bool seeded = false;
    shape_status status = keep_others(g, options, &kept, &seeded, error);
    if (!status)
        status = view_setting_options(g, seeded || g->seed != 1, &kept, error);
    if (status) {
        shape_scene_clear_options(&kept);
        return status;
    }
    shape_scene_clear_options(options);
    *options = kept;
    return SHAPE_OK;
}

static shape_status find_file(const char *path, char **file, shape_error *error)
{
    char *found;
    if (!*file)
        return SHAPE_OK;
    shape_status status = shape_scene_find_file(path, *file, cli_outside_allowed(), &found, error);
    if (status)
        return status;
    free(*file);
    *file = found;
    return SHAPE_OK;
}

shape_status view_entry_text(const shape_scene *scene, const char *path, const view_generator *g, char **text,
                             size_t *size, shape_error *error)
{
    shape_scene *copy = NULL;
    shape_status status = shape_scene_encode(scene, text, size, error);
    if (status)
        return status;
    status = shape_scene_decode(*text, *size, path, &copy, error);
    free(*text);
    if (!status)
        status = view_entry_apply(copy, g, error);
    for (size_t i = 0; !status && i < copy->cloud_count; i++) {
        status = find_file(path, &copy->clouds[i].file, error);
        if (!status)
            status = find_file(path, &copy->clouds[i].input, error);
    }
    if (!status)
        status = shape_scene_encode(copy, text, size, error);
    shape_scene_destroy(copy);
    return status;
}
