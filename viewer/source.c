/* What is shown: a .neph as it stands, a grammar as neph-lsys derives it, what a generator's program makes. */
#include "source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_scene.h"
#include "entry.h"
#include "run.h"
#include "setting.h"
#include "shape/file.h"
#include "shape/neph.h"
#include "shape/turtle.h"
#include "state_scene.h"

enum { MAX_SET_FILE = 0x40000000 };

/* Whether a file is a grammar: its name says so, or its bytes are text. A .neph begins with a byte that no text has. */
static bool is_grammar(const char *path, const unsigned char *bytes, size_t size)
{
    const char *dot = strrchr(path, '.');
    if (size && bytes[0] == 0x89)
        return false;
    if (dot && !strcmp(dot, ".lsys"))
        return true;
    if (dot && !strcmp(dot, ".neph"))
        return false;
    for (size_t i = 0; i < size && i < 64; i++)
        if (bytes[i] < 32 && bytes[i] != '\n' && bytes[i] != '\t' && bytes[i] != '\r')
            return false;
    return size > 0;
}

static void list_mistakes(const char *shown, const shape_mistakes *found, char *text, size_t room)
{
    size_t used = 0;
    text[0] = 0;
    for (int i = 0; i < found->count && used + 1 < room; i++) {
        int length = snprintf(text + used, room - used, "%s%s:%d:%d: %s", i ? "\n" : "", shown,
                              found->items[i].line, found->items[i].column, found->items[i].text);
        used += length > 0 ? (size_t)length : 0;
    }
}

/* A turtle that stops where nobody wants its cloud any more. */
typedef struct walk {
    shape_turtle *turtle;
    view_run *run;
    unsigned steps;
} walk;

static shape_status visit(void *user, const shape_symbol *symbol, shape_error *error)
{
    walk *w = user;
    if (++w->steps % 1024 == 0 && view_run_is_cancelled(w->run))
        return shape_error_set(error, SHAPE_ERROR_LIMIT, "broken off");
    return shape_turtle_visit(w->turtle, symbol, error);
}

static shape_status walk_string(const shape_grammar *grammar, const shape_derive_options *options,
                                view_run *run, shape_primitives *list, shape_derive_counts *counts,
                                shape_error *error)
{
    walk w = {.turtle = shape_turtle_create(grammar, options, list, error), .run = run};
    if (!w.turtle)
        return SHAPE_ERROR_MEMORY;
    shape_status status = shape_grammar_derive(grammar, options, visit, &w, counts, error);
    shape_turtle_destroy(w.turtle);
    return status;
}

static shape_status grow(const shape_grammar *grammar, const shape_derive_options *options, const char *path,
                         const char *shown, view_run *run, shape_set *set, shape_error *error)
{
    char name[SHAPE_NAME_MAX + 1];
    shape_derive_counts counts;
    cli_bare_name(path, "grammar", name);
    shape_status status = shape_set_add_cloud(set, name, NULL, error);
    if (!status)
        status = walk_string(grammar, options, run, shape_set_list(set, 0), &counts, error);
    if (!status && !counts.primitives)
        status = shape_error_set(error, SHAPE_ERROR_FORMAT, "%s: the derived string sets no puff", shown);
    if (status)
        return status;
    shape_cloud *cloud = &set->clouds[0];
    cloud->field = shape_grammar_get_settings(grammar)->field;
    cloud->medium = shape_grammar_get_settings(grammar)->medium;
    cloud->seed = cloud->field.seed = options->seed;
    return shape_cloud_choose_noise_scale(cloud, shape_set_list(set, 0), error);
}

/* A range of the settings over the file's; what is in force then goes back into the settings. */
static void use_range(view_generator *used, const char *name, shape_grammar_range *range)
{
    view_setting *setting = &used->settings[view_setting_find(used, name)];
    if (setting->given) {
        range->low = setting->number[0];
        range->high = setting->number[1];
    }
    setting->number[0] = range->low;
    setting->number[1] = range->high;
}

static void use_settings(view_generator *used, shape_derive_options *options)
{
    view_setting *iterations = &used->settings[view_setting_find(used, "iterations")];
    if (iterations->given)
        options->iterations = (int)iterations->number[0];
    iterations->number[0] = options->iterations;
    use_range(used, "angle", &options->angle);
    use_range(used, "radius", &options->radius);
    use_range(used, "length", &options->length);
    use_range(used, "shrink", &options->shrink);
}

static shape_status derive(const shape_grammar *grammar, const view_generator *generator, const char *path,
                           const char *shown, view_run *run, view_contents *contents, shape_error *error)
{
    shape_derive_options options = shape_derive_defaults(grammar);
    options.seed = generator->seed;
    contents->used = view_generator_named("neph-lsys", generator->seed);
    if (contents->used.which == generator->which)
        contents->used = *generator;
    use_settings(&contents->used, &options);
    contents->set = shape_set_create(error);
    if (!contents->set)
        return SHAPE_ERROR_MEMORY;
    shape_status status = grow(grammar, &options, path, shown, run, contents->set, error);
    if (status) {
        shape_set_destroy(contents->set);
        contents->set = NULL;
    }
    return status;
}

static shape_status read_grammar(const char *path, const char *shown, const unsigned char *bytes, size_t size,
                                 const view_generator *generator, view_run *run, view_contents *contents,
                                 char *mistakes, size_t room, shape_error *error)
{
    shape_mistakes *found = malloc(sizeof *found);
    shape_grammar *grammar;
    if (!found)
        return shape_error_memory(error);
    shape_status status = shape_grammar_parse(bytes, size, shown, &grammar, found, error);
    if (status == SHAPE_ERROR_FORMAT)
        list_mistakes(shown, found, mistakes, room);
    free(found);
    if (status)
        return status;
    status = derive(grammar, generator, path, shown, run, contents, error);
    shape_grammar_destroy(grammar);
    return status;
}

shape_status view_source_decode(const char *path, const unsigned char *bytes, size_t size,
                                const view_generator *generator, view_run *run, view_contents *contents,
                                char *mistakes, size_t room, shape_error *error)
{
    const char *shown = strcmp(path, "-") ? path : "standard input";
    shape_status status;
    memset(contents, 0, sizeof *contents);
    contents->used = view_generator_none(generator->seed);
    mistakes[0] = 0;
    if (is_grammar(path, bytes, size)) {
        status = read_grammar(path, shown, bytes, size, generator, run, contents, mistakes, room, error);
    } else {
        status = shape_neph_decode(bytes, size, &contents->set, error);
        if (status) {
            shape_error inner = *error;
            shape_error_set(error, status, "%s: %.400s", shown, inner.text);
        }
    }
    if (status && !mistakes[0])
        snprintf(mistakes, room, "%s", error->text);
    return status;
}

enum { ARGUMENTS_MAX = VIEW_SETTINGS_MAX + 6, ARGUMENT_ROOM = 160 };

/* What a generator's program makes. */
static shape_status run_generator(const char *path, view_run *run, view_contents *contents, char *mistakes,
                                  size_t room, shape_error *error)
{
    char texts[ARGUMENTS_MAX][ARGUMENT_ROOM], *arguments[ARGUMENTS_MAX] = {0};
    const view_generator *generator = &contents->used;
    const char *name = view_generator_program(generator);
    view_setting_row row;
    size_t count = 0;
    arguments[count++] = (char *)name;
    arguments[count++] = (char *)"-q";
    snprintf(texts[0], ARGUMENT_ROOM, "--seed=%llu", (unsigned long long)generator->seed);
    arguments[count++] = texts[0];
    for (int i = 0; view_setting_get_row(generator, i, &row); i++) {
        char value[ARGUMENT_ROOM / 2], *text = texts[i + 1];
        if (!generator->settings[i].given)
            continue;
        view_setting_text(&row, &generator->settings[i], value, sizeof value);
        snprintf(text, ARGUMENT_ROOM, "--%.40s%s%s", row.name, value[0] ? "=" : "", value);
        arguments[count++] = text;
    }
    arguments[count++] = (char *)"--";
    if (path[0])
        arguments[count++] = (char *)path;
    unsigned char *bytes;
    size_t size;
    shape_status status = view_run_program(run, arguments, NULL, &bytes, &size, mistakes, room, error);
    if (status)
        return status;
    status = shape_neph_decode(bytes, size, &contents->set, error);
    free(bytes);
    if (status)
        snprintf(mistakes, room, "%s: %.400s", name, error->text);
    return status;
}

static void fill_by_grammar(const char *path, view_generator *used)
{
    unsigned char *bytes;
    size_t size;
    shape_grammar *grammar;
    shape_error error;
    shape_mistakes *found = malloc(sizeof *found);
    if (!found || shape_file_read(path, MAX_SET_FILE, &bytes, &size, &error)) {
        free(found);
        return;
    }
    if (!shape_grammar_parse(bytes, size, path, &grammar, found, &error)) {
        shape_derive_options options = shape_derive_defaults(grammar);
        use_settings(used, &options);
        shape_grammar_destroy(grammar);
    }
    free(bytes);
    free(found);
}

void view_source_fill_entry(const shape_scene *scene, const char *path, view_generator *used)
{
    char *file;
    shape_error error;
    if (!used->entry || strcmp(view_generator_program(used), "neph-lsys") ||
        !scene->clouds[used->entry - 1].input ||
        shape_scene_find_file(path, scene->clouds[used->entry - 1].input, cli_outside_allowed(), &file,
                              &error))
        return;
    fill_by_grammar(file, used);
    free(file);
}

/* The scene with other options of its generator, for a program to read. */
static shape_status changed_scene(const shape_scene *scene, const char *path, const view_generator *asked,
                                  FILE **input, shape_error *error)
{
    char *text;
    size_t size;
    shape_status status = view_entry_text(scene, path, asked, &text, &size, error);
    if (status)
        return status;
    *input = tmpfile();
    bool good = *input && fwrite(text, 1, size, *input) == size && !fflush(*input);
    free(text);
    if (!good)
        return shape_error_set(error, SHAPE_ERROR_SYSTEM, "no temporary file (is the disk full?)");
    rewind(*input);
    return SHAPE_OK;
}

/* The clouds of a scene, by a program that can be ended, and that may end by a mistake in any of its files. */
static shape_status make_clouds(const char *path, const view_generator *asked, view_run *run,
                                view_contents *contents, char *mistakes, size_t room, shape_error *error)
{
    char left[32], *arguments[] = {(char *)"neph-edit", (char *)"-q", left, NULL, NULL, NULL, NULL};
    size_t count = 3, made_size;
    unsigned char *made;
    FILE *input = NULL;
    shape_status status = SHAPE_OK;
    bool changed = view_entry_stands(contents->scene, asked) && !view_generator_same(asked, &contents->used);
    if (changed)
        status = changed_scene(contents->scene, path, asked, &input, error);
    if (changed || cli_outside_allowed()) /* then its files have been looked for here */
        arguments[count++] = (char *)"--allow-outside";
    arguments[count++] = (char *)"--";
    arguments[count] = changed ? (char *)"-" : (char *)path;
    snprintf(left, sizeof left, "--leave-edits=%d", VIEW_CLOUDS_MAX); /* they are the panel's */
    if (!status)
        status = view_run_program(run, arguments, input, &made, &made_size, mistakes, room, error);
    if (input)
        fclose(input);
    if (status)
        return status;
    status = shape_neph_decode(made, made_size, &contents->set, error);
    free(made);
    return status;
}

/* A scene: light, camera and things are read here. asked: what the panel wants of the generator of one of its clouds, for as
 * long as the file says of it what it said before; contents->used gets what the file says. */
static shape_status read_scene(const char *path, const unsigned char *bytes, size_t size,
                               const view_generator *asked, view_run *run, view_contents *contents,
                               char *mistakes, size_t room, shape_error *error)
{
    shape_status status = shape_scene_decode(bytes, size, path, &contents->scene, error);
    if (!status)
        status = view_state_check_view(contents->scene, error);
    if (status) { /* the decoder has said where */
        snprintf(mistakes, room, "%s%s%s", contents->scene ? path : "", contents->scene ? ": " : "",
                 error->text);
        return status;
    }
    contents->used = view_entry_generator(contents->scene);
    view_source_fill_entry(contents->scene, path, &contents->used);
    return make_clouds(path, asked, run, contents, mistakes, room, error);
}

void view_contents_free(view_contents *contents)
{
    shape_set_destroy(contents->set);
    shape_scene_destroy(contents->scene);
    shape_opaque_destroy(contents->opaque);
    contents->set = NULL;
    contents->scene = NULL;
    contents->opaque = NULL;
}

static shape_status read_any(const char *path, const view_generator *generator, view_run *run,
                             view_contents *contents, char *mistakes, size_t room, shape_error *error)
{
    unsigned char *bytes;
    size_t size;
    view_generator none = view_generator_none(generator->seed);
    const view_generator *asked = generator;
    if (generator->entry) /* of a scene, which makes its clouds itself */
        generator = &none;
    contents->used = *generator;
    if (generator->which < 0)
        contents->used = view_generator_of_path(path, generator->seed);
    const char *program = view_generator_program(&contents->used);
    if (program[0] && strcmp(program, "neph-lsys"))
        return run_generator(path, run, contents, mistakes, room, error);
    shape_status status = shape_file_read(path, MAX_SET_FILE, &bytes, &size, error);
    if (status) {
        snprintf(mistakes, room, "%s", error->text);
        return status;
    }
    if (shape_scene_is(bytes, size))
        status = read_scene(path, bytes, size, asked, run, contents, mistakes, room, error);
    else
        status = view_source_decode(path, bytes, size, generator, run, contents, mistakes, room, error);
    free(bytes);
    return status;
}

shape_status view_source_read(const char *path, const view_generator *generator, view_run *run,
                              const view_more_things *more, bool things, view_contents *contents,
                              char *mistakes, size_t room, shape_error *error)
{
    static const view_more_things none;
    memset(contents, 0, sizeof *contents);
    mistakes[0] = 0;
    shape_status status = read_any(path, generator, run, contents, mistakes, room, error);
    if (!status && (things || contents->scene)) {
        status = view_things_read(contents->scene, path, cli_outside_allowed(), more ? more : &none,
                                  &contents->opaque, error);
        contents->things_read = true;
    }
    if (status) {
        view_contents_free(contents);
        if (!mistakes[0])
            snprintf(mistakes, room, "%s", error->text);
    }
    return status;
}
