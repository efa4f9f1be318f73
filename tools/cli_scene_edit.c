/* The edits of a scene: single clouds changed after all are made, by the names that they then have. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_private.h"
#include "cli_scene.h"

void cli_scene_edit_medium(const shape_scene_edit *edit, const char *place, shape_cloud *cloud)
{
    cli_medium mine = cli_medium_values;
    cli_medium_set(&edit->medium, place);
    cli_medium_apply(cloud);
    cli_medium_values = mine;
}

/* About the frame's origin, so that a cloud turns where it stands. */
static void place_cloud(const shape_scene_edit *edit, shape_cloud *cloud)
{
    shape_error error;
    shape_transform place = shape_transform_defaults();
    for (int i = 0; i < 3; i++) {
        place.translate[i] = edit->translate[i];
        place.rotate[i] = edit->rotate[i];
        place.scale[i] = edit->scale;
        place.pivot[i] = cloud->frame.m[i][3];
    }
    cli_check(shape_cloud_transform(cloud, &place, &error), &error);
}

static size_t find_cloud(const shape_set *set, const char *name)
{
    size_t i = 0;
    while (i < set->cloud_count && strcmp(set->clouds[i].name, name))
        i++;
    return i;
}

/* What lists the hidden ones leave behind is looked at by nobody. */
static void drop_hidden(shape_set *set, const bool *hidden)
{
    size_t kept = 0;
    for (size_t i = 0; i < set->cloud_count; i++)
        if (!hidden[i])
            set->clouds[kept++] = set->clouds[i];
    set->cloud_count = kept;
}

void cli_scene_edit(const shape_scene *scene, const char *shown, size_t first, shape_set *set)
{
    if (!scene->edit_count)
        return;
    bool *hidden = calloc(set->cloud_count + 1, sizeof *hidden);
    if (!hidden)
        cli_fail("not enough memory");
    for (size_t i = 0; i < scene->edit_count; i++) {
        const shape_scene_edit *edit = &scene->edits[i];
        char place[512];
        size_t index = find_cloud(set, edit->cloud);
        snprintf(place, sizeof place, "%.400s: edits[%zu]", shown, i);
        if (index == set->cloud_count)
            cli_fail("%s.cloud: there is no cloud \"%.60s\" (neph-info names them)", place, edit->cloud);
        shape_cloud changed = set->clouds[index];
        snprintf(place, sizeof place, "%.400s: edits[%zu].medium", shown, i);
        cli_scene_edit_medium(edit, place, &changed);
        snprintf(place, sizeof place, "%.400s: edits[%zu]: ", shown, i);
        cli_set_place("%s", place);
        place_cloud(edit, &changed);
        cli_set_place("%s", "");
        if (index < first)
            continue; /* it is a good edit, and left to others */
        set->clouds[index] = changed;
        hidden[index] = edit->hidden;
    }
    drop_hidden(set, hidden);
    free(hidden);
}
