/* The state as a scene. "view" has a row here for each number, word and switch that is no part of the clouds, the light or
 * the camera; what is as it is without being said is not written. */
#include "state_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_scene.h"

enum { TEXT_ROOM = 128 };

typedef enum row_kind { ROW_DOUBLE, ROW_FLOAT, ROW_INT, ROW_FLAG, ROW_WORD, ROW_THREE, ROW_DECAY } row_kind;

typedef struct view_row {
    const char *name;
    row_kind kind;
    size_t offset;
    double min, max;
    const char *words; /* of ROW_WORD: "a|b|c" */
} view_row;

#define AT(member) offsetof(view_state, member)

/* Names and ranges are those of neph-view's options where it has them. */
static const view_row rows[] = {
    {"method", ROW_WORD, AT(method), 0, 0, "default|exact|paper|paper-ndt"},
    {"right-method", ROW_WORD, AT(other_method), 0, 0, "default|exact|paper|paper-ndt"},
    {"samples", ROW_INT, AT(samples), 1, 65536, NULL},
    {"light-grid", ROW_INT, AT(light_grid), 2, 256, NULL},
    {"light", ROW_WORD, AT(lighting.law), 0, 0, VIEW_LAW_WORDS},
    {"powder", ROW_DOUBLE, AT(lighting.powder), 0, 1000, NULL},
    {"light-octaves", ROW_INT, AT(lighting.octaves), 1, 8, NULL},
    {"ambient", ROW_THREE, AT(lighting.ambient), 0, 1e9, NULL},
    {"emission", ROW_THREE, AT(lighting.emission), 0, 1e9, NULL},
    {"split", ROW_FLAG, AT(split), 0, 0, NULL},
    {"divider", ROW_FLOAT, AT(divider), 0, 1, NULL},
    {"heat", ROW_WORD, AT(heat), 0, 0, VIEW_HEAT_WORDS},
    {"boxes", ROW_FLAG, AT(boxes), 0, 0, NULL},
    {"primitives", ROW_WORD, AT(outlines), 0, 0, VIEW_OUTLINE_WORDS},
    {"difference", ROW_FLAG, AT(difference), 0, 0, NULL},
    {"time", ROW_DOUBLE, AT(time), -1e9, 1e9, NULL},
    {"turntable", ROW_DOUBLE, AT(course.turn_seconds), 0, 1e9, NULL},
    {"wind", ROW_THREE, AT(course.motion.wind), -1000, 1000, NULL},
    {"shear", ROW_DOUBLE, AT(course.motion.shear), -10, 10, NULL},
    {"drift", ROW_THREE, AT(course.motion.drift), -1000, 1000, NULL},
    {"life", ROW_DOUBLE, AT(course.motion.life), 0, 1e9, NULL},
    {"grow", ROW_DOUBLE, AT(course.motion.grow), 0, 1e9, NULL},
    {"decay", ROW_DECAY, AT(course.motion), 0, 1e9, NULL},
    {"day-speed", ROW_DOUBLE, AT(course.day_speed), -1000, 1000, NULL},
    {"morph-time", ROW_DOUBLE, AT(course.morph_seconds), 1e-3, 1e9, NULL},
};
enum { ROWS = sizeof rows / sizeof *rows };

/* --- numbers as texts, the shortest that read back as the same --- */

static void double_text(double value, char text[TEXT_ROOM])
{
    if (fabs(value) < 1e15 && value == floor(value)) {
        snprintf(text, TEXT_ROOM, "%.0f", value == 0 ? 0.0 : value);
        return;
    }
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(text, TEXT_ROOM, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            return;
    }
}

double view_neat(float value)
{
    char text[TEXT_ROOM];
    for (int digits = 1; digits < 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if ((float)strtod(text, NULL) == value)
            return strtod(text, NULL);
    }
    return (double)value;
}

static void join_numbers(const double *numbers, int count, const char *between, char text[TEXT_ROOM])
{
    size_t used = 0;
    for (int i = 0; i < count; i++) {
        char one[TEXT_ROOM];
        double_text(numbers[i], one);
        used += (size_t)snprintf(text + used, TEXT_ROOM - used, "%s%s", i ? between : "", one);
    }
}

/* Word number `place` of "a|b|c", or nothing. */
static void take_word(const char *words, int place, char text[TEXT_ROOM])
{
    for (; place > 0 && strchr(words, '|'); place--)
        words = strchr(words, '|') + 1;
    snprintf(text, TEXT_ROOM, "%.*s", (int)strcspn(words, "|"), words);
}

static int find_word(const char *words, const char *text)
{
    for (int place = 0;; place++) {
        size_t length = strcspn(words, "|");
        if (strlen(text) == length && !memcmp(words, text, length))
            return place;
        if (!words[length])
            return -1;
        words += length + 1;
    }
}

/* --- "view" --- */

/* A row's value as a scene's option; false where it is a switch that is off. */
static bool row_text(const view_row *row, const view_state *state, char text[TEXT_ROOM])
{
    const void *value = (const char *)state + row->offset;
    const shape_motion *motion = value;
    double range[2];
    switch (row->kind) {
    case ROW_FLAG:
        text[0] = 0;
        return *(const bool *)value;
    case ROW_WORD:
        take_word(row->words, *(const int *)value, text);
        return true;
    case ROW_INT:
        snprintf(text, TEXT_ROOM, "%d", *(const int *)value);
        return true;
    case ROW_FLOAT:
        double_text(view_neat(*(const float *)value), text);
        return true;
    case ROW_DOUBLE:
        double_text(*(const double *)value, text);
        return true;
    case ROW_THREE:
        join_numbers(value, 3, ",", text);
        return true;
    case ROW_DECAY:
        range[0] = motion->decay_start;
        range[1] = motion->decay_start + motion->decay;
        join_numbers(range, 2, "..", text);
        return motion->decay > 0;
    }
    return false;
}

void view_state_reset(view_state *state)
{
    shape_light light = shape_light_defaults();
    shape_view view = shape_view_defaults();
    view_state_clear(state);
    state->fov = view.fov;
    state->exposure = view.exposure;
    state->sun[0] = 60;
    state->sun[1] = 40;
    memcpy(state->sun_irradiance, light.sun_irradiance, sizeof state->sun_irradiance);
    state->sky = light.sky;
    state->lighting.powder = 2;
    state->lighting.octaves = 8;
    state->course = view_course_defaults();
    state->samples = 32;
    state->light_grid = 48;
    state->divider = 0.5f;
}

static shape_status save_view(const view_state *state, shape_scene *scene, shape_error *error)
{
    view_state *plain = malloc(sizeof *plain);
    shape_status status = SHAPE_OK;
    if (!plain)
        return shape_error_memory(error);
    view_state_reset(plain);
    shape_scene_clear_options(&scene->view);
    for (int i = 0; i < ROWS && !status; i++) {
        char is[TEXT_ROOM], usual[TEXT_ROOM];
        bool has = row_text(&rows[i], state, is), had = row_text(&rows[i], plain, usual);
        if (has && (!had || strcmp(is, usual)))
            status = shape_scene_add_option(&scene->view, rows[i].name, rows[i].kind == ROW_FLAG ? NULL : is,
                                            error);
    }
    free(plain);
    return status;
}

static shape_status wrong(const view_row *row, const char *text, const char *expected, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_FORMAT, "view.%s \"%.60s\": expected %s", row->name, text,
                           expected);
}

static bool read_numbers(const view_row *row, const char *text, int count, double *numbers)
{
    bool good = cli_numbers(text, count, numbers);
    for (int i = 0; i < count && good; i++)
        good = numbers[i] >= row->min && numbers[i] <= row->max;
    return good;
}

static bool read_decay(const view_row *row, const char *text, double range[2])
{
    char low[TEXT_ROOM];
    const char *dots = strstr(text, "..");
    if (!dots || dots - text >= TEXT_ROOM)
        return false;
    snprintf(low, sizeof low, "%.*s", (int)(dots - text), text);
    return read_numbers(row, low, 1, &range[0]) && read_numbers(row, dots + 2, 1, &range[1]) &&
           range[1] > range[0];
}

/* Text NULL: a flag. */
static shape_status load_row(const view_row *row, const char *text, view_state *state, shape_error *error)
{
    void *value = (char *)state + row->offset;
    double n[3] = {0};
    char expected[160];
    snprintf(expected, sizeof expected, "a number from %.9g to %.9g", row->min, row->max);
    if ((row->kind == ROW_FLAG) != !text)
        return wrong(row, text ? text : "true", row->kind == ROW_FLAG ? "true" : "a value", error);
    switch (row->kind) {
    case ROW_FLAG:
        *(bool *)value = true;
        return SHAPE_OK;
    case ROW_WORD:
        if (find_word(row->words, text) < 0)
            return wrong(row, text, row->words, error);
        *(int *)value = find_word(row->words, text);
        return SHAPE_OK;
    case ROW_THREE:
        snprintf(expected, sizeof expected, "three numbers, each from %.9g to %.9g", row->min, row->max);
        if (!read_numbers(row, text, 3, value))
            return wrong(row, text, expected, error);
        return SHAPE_OK;
    case ROW_DECAY:
        if (!read_decay(row, text, n))
            return wrong(row, text, "a range A..B of seconds", error);
        ((shape_motion *)value)->decay_start = n[0];
        ((shape_motion *)value)->decay = n[1] - n[0];
        return SHAPE_OK;
    case ROW_INT:
    case ROW_FLOAT:
    case ROW_DOUBLE:
        break;
    }
    if (!read_numbers(row, text, 1, n) || (row->kind == ROW_INT && n[0] != floor(n[0])))
        return wrong(row, text, expected, error);
    if (row->kind == ROW_INT)
        *(int *)value = (int)n[0];
    else if (row->kind == ROW_FLOAT)
        *(float *)value = (float)n[0];
    else
        *(double *)value = n[0];
    return SHAPE_OK;
}

shape_status view_state_load_view(view_state *state, const shape_scene *scene,
                                  bool (*given)(const char *name), shape_error *error)
{
    for (size_t i = 0; i < scene->view.count; i++) {
        const shape_scene_option *option = &scene->view.items[i];
        int row = 0;
        while (row < ROWS && strcmp(rows[row].name, option->name))
            row++;
        if (row == ROWS)
            return shape_error_set(error, SHAPE_ERROR_FORMAT, "view: there is no key \"%.40s\"",
                                   option->name);
        bool skip = given && given(option->name);
        shape_status status = skip ? SHAPE_OK : load_row(&rows[row], option->text, state, error);
        if (status)
            return status;
    }
    return SHAPE_OK;
}

shape_status view_state_check_view(const shape_scene *scene, shape_error *error)
{
    view_state *ignored = malloc(sizeof *ignored);
    if (!ignored)
        return shape_error_memory(error);
    view_state_reset(ignored);
    shape_status status = view_state_load_view(ignored, scene, NULL, error);
    free(ignored);
    return status;
}

/* --- light and camera --- */

static void save_light(const view_state *state, shape_scene *scene)
{
    scene->sun_none = false;
    scene->sun_given = scene->sun_irradiance_given = scene->sky_given = true;
    memcpy(scene->sun, state->sun, sizeof scene->sun);
    scene->sky = state->sky;
    for (int i = 0; i < 3; i++) {
        scene->sun_irradiance[i] = view_neat(state->sun_irradiance[i]);
        scene->sky_radiance[i] = view_neat(state->sky_radiance[i]);
    }
    scene->air_given = state->air.visibility > 0;
    scene->visibility = state->air.visibility;
    scene->air_height = state->air.height;
    scene->day_given = state->course.day_runs;
    scene->day = state->course.day;
    scene->eye_given = scene->target_given = scene->fov_given = scene->exposure_given = true;
    memcpy(scene->eye, state->eye, sizeof scene->eye);
    memcpy(scene->target, state->target, sizeof scene->target);
    scene->fov = state->fov;
    scene->exposure = view_neat(state->exposure);
}

static void to_floats(const double from[3], float to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = (float)from[i];
}

void view_state_load_light(view_state *state, const shape_scene *scene)
{
    if (scene->sun_given)
        memcpy(state->sun, scene->sun, sizeof state->sun);
    if (scene->sun_irradiance_given)
        to_floats(scene->sun_irradiance, state->sun_irradiance);
    if (scene->sun_none)
        memset(state->sun_irradiance, 0, sizeof state->sun_irradiance);
    if (scene->sky_given) {
        state->sky = scene->sky;
        to_floats(scene->sky_radiance, state->sky_radiance);
    }
    state->air = (shape_air){0};
    if (scene->air_given)
        state->air = (shape_air){scene->visibility, scene->air_height};
    state->course.day_runs = scene->day_given;
    if (scene->day_given)
        state->course.day = scene->day;
    if (scene->eye_given)
        memcpy(state->eye, scene->eye, sizeof state->eye);
    if (scene->target_given)
        memcpy(state->target, scene->target, sizeof state->target);
    if (scene->fov_given)
        state->fov = scene->fov;
    if (scene->exposure_given)
        state->exposure = (float)scene->exposure;
}

/* --- edits --- */

static const char phases[] = "hg|isotropic|rayleigh|mie|two-lobe";

/* What of field and medium is other than it was made: each knob that has an option, and the phase function. */
static shape_status save_medium(const view_state *state, const view_state *made, int cloud,
                                shape_scene_edit *edit, shape_error *error)
{
    char text[TEXT_ROOM];
    shape_status status = SHAPE_OK;
    shape_phase_kind phase = state->clouds[cloud].medium.phase;
    if (phase != made->clouds[cloud].medium.phase) {
        take_word(phases, (int)phase, text);
        status = shape_scene_add_option(&edit->medium, "phase", text, error);
    }
    for (size_t i = 0; i < view_knob_count && !status; i++) {
        const view_knob *knob = &view_knobs[i];
        if (knob->of != VIEW_OF_FIELD && knob->of != VIEW_OF_MEDIUM)
            continue;
        double value = view_knob_get(knob, state, cloud);
        if (value == view_knob_get(knob, made, cloud))
            continue;
        double_text(knob->kind == VIEW_KNOB_FLOAT ? view_neat((float)value) : value, text);
        status = shape_scene_add_option(&edit->medium, knob->option, text, error);
    }
    return status;
}

static bool is_placed(const view_cloud *c)
{
    for (int i = 0; i < 3; i++)
        if (c->move[i] != 0 || c->turn[i] != 0)
            return true;
    return c->scale != 1 || !c->visible;
}

static shape_status save_edit(const view_state *state, const view_state *made, int cloud, shape_scene *scene,
                              shape_error *error)
{
    const view_cloud *c = &state->clouds[cloud];
    shape_scene_edit *edit;
    shape_status status = shape_scene_add_edit(scene, c->name, &edit, error);
    if (!status)
        status = save_medium(state, made, cloud, edit, error);
    if (status)
        return status;
    if (!edit->medium.count && !is_placed(c)) {
        free(edit->cloud); /* nothing is changed of this one */
        memset(edit, 0, sizeof *edit);
        scene->edit_count--;
        return SHAPE_OK;
    }
    memcpy(edit->translate, c->move, sizeof c->move);
    memcpy(edit->rotate, c->turn, sizeof c->turn);
    edit->scale = c->scale;
    edit->hidden = !c->visible;
    return SHAPE_OK;
}

/* Edits of clouds that the state does not have, beyond the first ones, stay as they are. */
static void drop_edits_of(shape_scene *scene, const view_state *state)
{
    size_t kept = 0;
    for (size_t i = 0; i < scene->edit_count; i++) {
        bool own = false;
        for (int k = 0; k < state->cloud_count; k++)
            own = own || !strcmp(scene->edits[i].cloud, state->clouds[k].name);
        if (own) {
            free(scene->edits[i].note);
            free(scene->edits[i].cloud);
            shape_scene_clear_options(&scene->edits[i].medium);
        } else {
            scene->edits[kept++] = scene->edits[i];
        }
    }
    scene->edit_count = kept;
}

static shape_status save_edits(const view_state *state, const shape_set *set, shape_scene *scene,
                               shape_error *error)
{
    view_state *made = malloc(sizeof *made);
    if (!made)
        return shape_error_memory(error);
    shape_status status = SHAPE_OK;
    view_state_reset(made);
    view_state_take_set(made, set, &state->generator);
    drop_edits_of(scene, state);
    for (int i = 0; i < state->cloud_count && i < made->cloud_count && !status; i++)
        status = save_edit(state, made, i, scene, error);
    free(made);
    return status;
}

shape_status view_state_save(const view_state *state, const shape_set *made, shape_scene *scene,
                             shape_error *error)
{
    save_light(state, scene);
    shape_status status = save_view(state, scene, error);
    return status ? status : save_edits(state, made, scene, error);
}

void view_state_load_edits(view_state *state, const shape_scene *scene)
{
    for (size_t i = 0; i < scene->edit_count; i++) {
        const shape_scene_edit *edit = &scene->edits[i];
        for (int k = 0; k < state->cloud_count; k++) {
            view_cloud *c = &state->clouds[k];
            shape_cloud cloud;
            if (strcmp(edit->cloud, c->name))
                continue;
            memset(&cloud, 0, sizeof cloud);
            memcpy(&cloud.field, &c->field, sizeof c->field); /* gaps too: states are compared as bytes */
            memcpy(&cloud.medium, &c->medium, sizeof c->medium);
            cli_scene_edit_medium(edit, "scene: edits", &cloud);
            memcpy(&c->field, &cloud.field, sizeof c->field);
            memcpy(&c->medium, &cloud.medium, sizeof c->medium);
            memcpy(c->move, edit->translate, sizeof c->move);
            memcpy(c->turn, edit->rotate, sizeof c->turn);
            c->scale = edit->scale;
            c->visible = !edit->hidden;
        }
    }
}
