/* The state of the window: what it stands for, and how it changes when the file does. */
#include "state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape/combine.h"
#include "shape/transform.h"

void view_state_clear(view_state *state)
{
    memset(state, 0, sizeof *state);
}

void view_state_take_set(view_state *state, const shape_set *set, const view_generator *used)
{
    size_t count = set->cloud_count < VIEW_CLOUDS_MAX ? set->cloud_count : VIEW_CLOUDS_MAX;
    memset(state->clouds, 0, sizeof state->clouds);
    state->cloud_count = (int)count;
    memcpy(&state->generator, used, sizeof *used);
    for (size_t i = 0; i < count; i++) {
        view_cloud *c = &state->clouds[i];
        memcpy(c->name, set->clouds[i].name, sizeof c->name);
        memcpy(&c->field, &set->clouds[i].field, sizeof c->field);
        memcpy(&c->medium, &set->clouds[i].medium, sizeof c->medium);
        for (int axis = 0; axis < 3; axis++)
            c->origin[axis] = set->clouds[i].frame.m[axis][3];
        c->scale = 1;
        c->visible = true;
    }
}

/* One number of a cloud: where it was not changed, the file's new one. */
static void merge_bytes(void *own, const void *base, const void *next, size_t size)
{
    if (!memcmp(own, base, size))
        memcpy(own, next, size);
}

void view_state_merge(view_state *state, const view_state *base, const view_state *next)
{
    view_cloud old[VIEW_CLOUDS_MAX];
    memcpy(old, state->clouds, sizeof old);
    int known = state->cloud_count < base->cloud_count ? state->cloud_count : base->cloud_count;
    memcpy(state->clouds, next->clouds, sizeof state->clouds);
    state->cloud_count = next->cloud_count;
    for (int i = 0; i < known && i < next->cloud_count; i++) {
        view_cloud *c = &state->clouds[i], own;
        memcpy(&own, &old[i], sizeof own);
        const view_cloud *b = &base->clouds[i], *n = &next->clouds[i];
        if (strcmp(own.name, n->name))
            continue; /* another cloud */
        const unsigned char *from[] = {(void *)&b->field, (void *)&b->medium};
        const unsigned char *to[] = {(void *)&n->field, (void *)&n->medium};
        unsigned char *mine[] = {(void *)&own.field, (void *)&own.medium};
        const size_t sizes[] = {sizeof own.field, sizeof own.medium};
        for (int part = 0; part < 2; part++) /* members are of four bytes, or halves of eight */
            for (size_t at = 0; at + 4 <= sizes[part]; at += 4)
                merge_bytes(mine[part] + at, from[part] + at, to[part] + at, 4);
        merge_bytes(own.move, b->move, n->move, sizeof own.move);
        merge_bytes(own.turn, b->turn, n->turn, sizeof own.turn);
        merge_bytes(&own.scale, &b->scale, &n->scale, sizeof own.scale);
        merge_bytes(&own.visible, &b->visible, &n->visible, sizeof own.visible);
        memcpy(own.origin, n->origin, sizeof own.origin);
        memcpy(c, &own, sizeof own);
    }
    /* A scene's entry that says something else than before. */
    if (state->generator.entry != next->generator.entry || state->generator.digest != next->generator.digest)
        memcpy(&state->generator, &next->generator, sizeof state->generator);
    for (int i = 0; i < VIEW_SETTINGS_MAX; i++)
        if (!state->generator.settings[i].given && !next->generator.settings[i].given) /* the file's own */
            state->generator.settings[i] = next->generator.settings[i];
}

shape_view view_state_view(const view_state *state, int width, int height)
{
    shape_view view = {.width = width, .height = height, .fov = state->fov, .exposure = state->exposure};
    view.eye = shape_dvec3_make(state->eye[0], state->eye[1], state->eye[2]);
    view.target = shape_dvec3_make(state->target[0], state->target[1], state->target[2]);
    view_course_view(&state->course, state->time, &view);
    return view;
}

shape_light view_state_light(const view_state *state)
{
    shape_light light = shape_light_defaults();
    light.sun = shape_sun_direction(state->sun[0], state->sun[1]);
    memcpy(light.sun_irradiance, state->sun_irradiance, sizeof light.sun_irradiance);
    light.sky = state->sky;
    memcpy(light.sky_radiance, state->sky_radiance, sizeof light.sky_radiance);
    light.air = state->air;
    view_course_light(&state->course, state->time, &light);
    return light;
}

static bool is_moved(const view_cloud *c)
{
    for (int i = 0; i < 3; i++)
        if (c->move[i] != 0 || c->turn[i] != 0)
            return true;
    return c->scale != 1;
}

static shape_status change_cloud(shape_set *set, size_t index, const view_cloud *c, bool *selected,
                                 shape_error *error)
{
    shape_cloud *cloud = &set->clouds[index];
    cloud->field = c->field;
    cloud->medium = c->medium;
    if (!is_moved(c))
        return SHAPE_OK;
    shape_transform transform = shape_transform_defaults();
    for (int i = 0; i < 3; i++) {
        transform.translate[i] = c->move[i];
        transform.rotate[i] = c->turn[i];
        transform.scale[i] = c->scale;
        transform.pivot[i] = cloud->frame.m[i][3];
    }
    memset(selected, 0, set->cloud_count * sizeof *selected);
    selected[index] = true;
    return shape_set_transform(set, selected, &transform, error);
}

/* Hidden clouds leave the set; what lists they leave behind is not looked at by anyone. */
static void drop_hidden(shape_set *set, const view_state *state)
{
    size_t kept = 0;
    for (size_t i = 0; i < set->cloud_count; i++)
        if (i >= (size_t)state->cloud_count || state->clouds[i].visible)
            set->clouds[kept++] = set->clouds[i];
    set->cloud_count = kept;
}

static shape_status change_clouds(const view_state *state, shape_set *set, shape_error *error)
{
    shape_status status = SHAPE_OK;
    bool *selected = calloc(set->cloud_count + 1, sizeof *selected);
    if (!selected)
        return shape_error_memory(error);
    for (int i = 0; i < state->cloud_count && (size_t)i < set->cloud_count && !status; i++)
        status = change_cloud(set, (size_t)i, &state->clouds[i], selected, error);
    free(selected);
    if (!status)
        drop_hidden(set, state);
    return status;
}

/* The set with the changes, before anything moves, as neph-edit and a scene's edits make it. */
static shape_status edited_copy(const view_state *state, const shape_set *set, shape_set **made,
                                shape_error *error)
{
    *made = shape_set_create(error);
    if (!*made)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_set_append(*made, set, error);
    return status ? status : change_clouds(state, *made, error);
}

shape_status view_state_set(const view_state *state, const shape_set *set, const shape_morph *morph,
                            shape_set **made, shape_error *error)
{
    shape_set *moved = NULL, *edited = NULL;
    bool before =
        !morph && shape_motion_is_on(&state->course.motion); /* a morph knows its own clouds alone */
    shape_status status = before ? edited_copy(state, set, &edited, error) : SHAPE_OK;
    if (!status)
        status = view_course_set(&state->course, edited ? edited : set, morph, state->time, &moved, error);
    if (!status && !before)
        status = change_clouds(state, moved, error);
    if (!status)
        status = shape_set_check(moved, error);
    shape_set_destroy(edited);
    if (status)
        shape_set_destroy(moved);
    else
        *made = moved;
    return status;
}

bool view_state_same_clouds(const view_state *a, const view_state *b)
{
    return a->cloud_count == b->cloud_count && !memcmp(a->clouds, b->clouds, sizeof a->clouds) &&
           !memcmp(&a->course.motion, &b->course.motion, sizeof a->course.motion) &&
           a->course.morph_seconds == b->course.morph_seconds;
}

bool view_state_same_light(const view_state *a, const view_state *b)
{
    shape_light x = view_state_light(a), y = view_state_light(b);
    return x.sun.x == y.sun.x && x.sun.y == y.sun.y && x.sun.z == y.sun.z && x.sky == y.sky &&
           !memcmp(x.sun_irradiance, y.sun_irradiance, sizeof x.sun_irradiance) &&
           !memcmp(x.sky_radiance, y.sky_radiance, sizeof x.sky_radiance) &&
           x.air.visibility == y.air.visibility && x.air.height == y.air.height &&
           !memcmp(&a->lighting, &b->lighting, sizeof a->lighting);
}

/* --- undo --- */

enum { KEPT = 64 };

struct view_history {
    view_state states[KEPT];
    int count, current;
};

view_history *view_history_create(const view_state *state)
{
    view_history *history = calloc(1, sizeof *history);
    if (!history)
        return NULL;
    memcpy(&history->states[0], state, sizeof *state);
    history->count = 1;
    return history;
}

void view_history_destroy(view_history *history)
{
    free(history);
}

static void copy_camera(view_state *to, const view_state *from)
{
    memcpy(to->eye, from->eye, sizeof to->eye);
    memcpy(to->target, from->target, sizeof to->target);
}

void view_history_keep(view_history *history, const view_state *state)
{
    view_state *last = &history->states[history->current];
    copy_camera(last, state);
    if (!memcmp(last, state, sizeof *state))
        return;
    if (history->current + 1 == KEPT) {
        memmove(&history->states[0], &history->states[1], (KEPT - 1) * sizeof *state);
        history->current--;
    }
    memcpy(&history->states[++history->current], state, sizeof *state);
    history->count = history->current + 1;
}

static bool go(view_history *history, view_state *state, int by)
{
    int to = history->current + by;
    if (to < 0 || to >= history->count)
        return false;
    history->current = to;
    copy_camera(&history->states[to], state);
    memcpy(state, &history->states[to], sizeof *state);
    return true;
}

bool view_history_undo(view_history *history, view_state *state)
{
    return go(history, state, -1);
}

bool view_history_redo(view_history *history, view_state *state)
{
    return go(history, state, 1);
}

void view_history_merge(view_history *history, const view_state *base, const view_state *next)
{
    for (int i = 0; i < history->count; i++)
        view_state_merge(&history->states[i], base, next);
}
