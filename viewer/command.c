/* The commands that make what is seen, from the numbers that differ from the file's. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "setting.h"
#include "shape_gl.h"
#include "state.h"

typedef struct text_end {
    char *text;
    size_t used, room;
} text_end;

static void add(text_end *end, const char *format, ...) SHAPE_PRINTF(2, 3);
static void add(text_end *end, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(end->text + end->used, end->room - end->used, format, arguments);
    va_end(arguments);
    end->used += length > 0 ? (size_t)length : 0;
    if (end->used >= end->room)
        end->used = end->room - 1;
}

/* A path as a shell reads it back. */
static void add_path(text_end *end, const char *path)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+=@:";
    if (*path && strspn(path, plain) == strlen(path)) {
        add(end, " %s", path);
        return;
    }
    add(end, " '");
    for (const char *c = path; *c; c++)
        add(end, *c == '\'' ? "'\\''" : "%c", *c);
    add(end, "'");
}

static void add_vector(text_end *end, const char *option, const double v[3])
{
    add(end, " --%s %.9g,%.9g,%.9g", option, v[0], v[1], v[2]);
}

static void add_knobs(text_end *end, const view_state *state, const view_state *base, int cloud,
                      bool of_cloud)
{
    for (size_t i = 0; i < view_knob_count; i++) {
        const view_knob *knob = &view_knobs[i];
        if (!knob->option || !strcmp(knob->group, "Air") || !strcmp(knob->group, "Light") ||
            (knob->of != VIEW_OF_STATE) != of_cloud)
            continue;
        bool day = !strcmp(knob->group, "Day");
        if (day && !state->course.day_runs)
            continue;
        double value = view_knob_get(knob, state, cloud);
        if (value != view_knob_get(knob, base, cloud) || !strcmp(knob->option, "day"))
            add(end, " --%s %.9g", knob->option, value);
    }
    static const char *const phases[] = {"hg", "isotropic", "rayleigh", "mie", "two-lobe"};
    if (of_cloud && state->clouds[cloud].medium.phase != base->clouds[cloud].medium.phase)
        add(end, " --phase %s", phases[state->clouds[cloud].medium.phase]);
}

static bool is_changed(const view_state *state, const view_state *base, int cloud)
{
    char text[512] = "";
    text_end end = {text, 0, sizeof text};
    add_knobs(&end, state, base, cloud, true);
    return end.used > 0;
}

static bool is_placed(const view_cloud *c)
{
    for (int i = 0; i < 3; i++)
        if (c->move[i] != 0 || c->turn[i] != 0)
            return true;
    return c->scale != 1;
}

/* One neph-edit that changes and places a cloud; from a file, or from the command before in the pipe. */
static void add_edit(text_end *end, const view_state *state, const view_state *base, int cloud, bool medium)
{
    const view_cloud *c = &state->clouds[cloud];
    if (state->cloud_count > 1) {
        add(end, " --cloud");
        add_path(end, c->name);
    }
    if (medium)
        add_knobs(end, state, base, cloud, true);
    bool turned = c->scale != 1 || c->turn[0] != 0 || c->turn[1] != 0 || c->turn[2] != 0;
    if (turned && (c->origin[0] != 0 || c->origin[1] != 0 || c->origin[2] != 0))
        add_vector(end, "pivot", c->origin);
    if (c->scale != 1)
        add(end, " --scale %.9g,%.9g,%.9g", c->scale, c->scale, c->scale);
    if (c->turn[0] != 0 || c->turn[1] != 0 || c->turn[2] != 0)
        add_vector(end, "rotate", c->turn);
    if (c->move[0] != 0 || c->move[1] != 0 || c->move[2] != 0)
        add_vector(end, "translate", c->move);
}

static void add_settings(text_end *end, const view_generator *g)
{
    view_setting_row row;
    for (int i = 0; view_setting_get_row(g, i, &row); i++) {
        char value[96];
        if (!g->settings[i].given)
            continue;
        view_setting_text(&row, &g->settings[i], value, sizeof value);
        add(end, " --%s%s%s", row.name, value[0] ? " " : "", value);
    }
}

/* What makes the file that is looked at; false where it is the one that was opened. */
static bool add_maker(text_end *end, const view_state *state, const view_state *base, const char *path)
{
    const view_generator *g = &state->generator;
    bool piped = false, made = g->which >= 0 && !g->entry; /* a scene makes its own */
    if (made) {
        add(end, "%s", view_generator_program(g));
        if (path[0])
            add_path(end, path);
        add_settings(end, g);
        add(end, " --seed %llu", (unsigned long long)g->seed);
        if (state->cloud_count)
            add_knobs(end, state, base, 0, true);
        piped = true;
    }
    for (int i = 0; i < state->cloud_count; i++) {
        bool medium = !made && is_changed(state, base, i);
        if (!medium && !is_placed(&state->clouds[i]))
            continue;
        add(end, piped ? " | neph-edit -" : "neph-edit");
        if (!piped)
            add_path(end, path);
        add_edit(end, state, base, i, medium);
        piped = true;
    }
    return piped;
}

/* By what the clouds are lit: what is not as usual, and of a scene also what may be otherwise in it. */
static void add_lighting(text_end *end, const view_lighting *l, bool scene)
{
    static const char *const laws[] = {"grid", "single", "powder", "powder-angle", "beer-max", "octaves"};
    static const double none[3];
    if (scene || l->law != SHAPE_GL_LAW_GRID)
        add(end, " --light %s", laws[l->law]);
    if (l->law == SHAPE_GL_LAW_POWDER || l->law == SHAPE_GL_LAW_POWDER_ANGLE)
        add(end, " --powder %.9g", l->powder);
    if (l->law == SHAPE_GL_LAW_OCTAVES)
        add(end, " --light-octaves %d", l->octaves);
    if (scene || memcmp(l->ambient, none, sizeof none) != 0)
        add_vector(end, "ambient", l->ambient);
    if (scene || memcmp(l->emission, none, sizeof none) != 0)
        add_vector(end, "emission", l->emission);
}

static void add_light(text_end *end, const view_state *state, bool scene)
{
    if (!state->course.day_runs)
        add(end, " --sun %.9g,%.9g", state->sun[0], state->sun[1]);
    const float *sun = state->sun_irradiance, *sky = state->sky_radiance;
    shape_light usual = shape_light_defaults();
    /* A scene has its own, which the usual ones must be said to replace. */
    if (scene || memcmp(sun, usual.sun_irradiance, sizeof usual.sun_irradiance))
        add(end, " --sun-irradiance %.9g,%.9g,%.9g", (double)sun[0], (double)sun[1], (double)sun[2]);
    if (scene && state->sky == SHAPE_SKY_CLEAR)
        add(end, " --sky clear");
    if (state->sky == SHAPE_SKY_NONE)
        add(end, " --sky none");
    else if (state->sky == SHAPE_SKY_CONSTANT)
        add(end, " --sky %.9g,%.9g,%.9g", (double)sky[0], (double)sky[1], (double)sky[2]);
    if (scene || state->air.visibility > 0)
        add(end, " --visibility %.9g", state->air.visibility);
    if (state->air.visibility > 0 && (scene || state->air.height > 0))
        add(end, " --air-height %.9g", state->air.height);
}

void view_command_write(const view_state *state, const view_state *base, const view_command *command,
                        char *text, size_t room)
{
    static const char *const methods[] = {"default", "exact", "paper", "paper-ndt"};
    text_end end = {text, 0, room};
    text[0] = 0;
    bool made = !command->volume && add_maker(&end, state, base, command->path);
    if (made)
        add(&end, " -o cloud.neph\n");
    add(&end, "neph-view");
    add_path(&end, made ? "cloud.neph" : command->path);
    if (!made)
        add(&end, "%s", command->opening);
    add(&end, "%s", command->things);
    if (command->volume && state->cloud_count)
        add_knobs(&end, state, base, 0, true); /* after the options that opened it, so that these hold */
    add(&end, " --headless --size %dx%d --method %s", command->size[0], command->size[1],
        methods[state->method]);
    add_vector(&end, "eye", state->eye);
    add_vector(&end, "target", state->target);
    add(&end, " --fov %.9g --exposure %.9g", state->fov, (double)state->exposure);
    add_light(&end, state, command->scene);
    if (state->method < SHAPE_GL_PAPER)
        add_lighting(&end, &state->lighting, command->scene);
    view_state start;
    memcpy(&start, base, sizeof start);
    start.fov = state->fov; /* said already */
    start.exposure = state->exposure;
    start.course = view_course_defaults();
    start.samples = 32;
    start.light_grid = 48;
    add_knobs(&end, state, &start, 0, false);
    if (state->course.motion.wind[0] != 0 || state->course.motion.wind[1] != 0 ||
        state->course.motion.wind[2] != 0)
        add_vector(&end, "wind", state->course.motion.wind);
    if (state->course.motion.drift[0] != 0 || state->course.motion.drift[1] != 0 ||
        state->course.motion.drift[2] != 0)
        add_vector(&end, "drift", state->course.motion.drift);
    const shape_motion *motion = &state->course.motion;
    if (motion->decay > 0)
        add(&end, " --decay %.9g..%.9g", motion->decay_start, motion->decay_start + motion->decay);
    if (command->morph) {
        add(&end, " --morph");
        add_path(&end, command->morph);
        add(&end, " --morph-time %.9g", state->course.morph_seconds);
    }
    if (command->seed != 1)
        add(&end, " --seed %llu", (unsigned long long)command->seed);
    if (command->alpha)
        add(&end, " --alpha");
    if (command->paper_lod)
        add(&end, " --paper-lod");
    if (state->time != 0)
        add(&end, " --time %.9g", state->time);
    add(&end, " -o cloud.png\n");
}
