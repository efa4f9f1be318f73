/* Generators as programs of their own, and from within others. */
#include "cli_generator.h"

#include <stdio.h>
#include <string.h>

#include "cli_private.h"
#include "cli_scene.h"

/* --- as a program --- */

void cli_generator_parse(const cli_program *program, const cli_generator *generator, const cli_option *more,
                         int argc, char **argv, cli_common *common)
{
    enum { ROOM = 8 };
    static cli_group groups[ROOM];
    int count = 0;
    for (const cli_group *group = generator->groups; group->title && count < ROOM - 3; group++)
        groups[count++] = *group;
    if (more)
        groups[count++] = (cli_group){"Showing", more};
    groups[count++] = (cli_group){"Scene", cli_save_options};
    cli_program whole = *program;
    whole.groups = groups;
    cli_parse(&whole, argc, argv, common);
    cli_save_check(common);
}

int cli_generator_main(const cli_program *program, const cli_generator *generator,
                       shape_set *(*make)(const char *input, uint64_t seed), int argc, char **argv)
{
    cli_common common;
    cli_generator_parse(program, generator, NULL, argc, argv, &common);
    shape_set *set = make(generator->input ? common.arguments[0] : NULL, common.seed);
    cli_write_set(&common, set);
    shape_set_destroy(set);
    cli_generator_save(generator, &common);
    return cli_finish(&common);
}

/* --- from within another --- */

/* Bytes of an option's variable; 0 for flags of one byte would be wrong, so every kind is named. */
static size_t size_of_kind(cli_kind kind)
{
    switch (kind) {
    case CLI_FLAG:
        return sizeof(bool);
    case CLI_NUMBER:
        return sizeof(double);
    case CLI_INTEGER:
        return sizeof(int64_t);
    case CLI_SEED:
        return sizeof(uint64_t);
    case CLI_VECTOR:
        return 3 * sizeof(double);
    case CLI_PAIR:
    case CLI_RANGE:
        return 2 * sizeof(double);
    case CLI_SIZE:
        return 2 * sizeof(int64_t);
    case CLI_CHOICE:
        return sizeof(int);
    case CLI_TEXTS:
        return 0; /* no generator has one */
    case CLI_TEXT:
        break;
    }
    return sizeof(const char *);
}

/* What an option's variables held. */
typedef struct saved_option {
    const cli_option *option;
    unsigned char value[3 * sizeof(double)];
    bool given;
} saved_option;

static int save_options(const cli_group *groups, saved_option *saved)
{
    int count = 0;
    for (const cli_group *group = groups; group->title; group++)
        for (const cli_option *o = group->options; o->name && count < CLI_MAX_OPTIONS; o++, count++) {
            saved[count].option = o;
            saved[count].given = o->given && *o->given;
            memcpy(saved[count].value, o->value, size_of_kind(o->kind));
        }
    return count;
}

static void restore_options(const saved_option *saved, int count)
{
    for (int i = 0; i < count; i++) {
        const cli_option *o = saved[i].option;
        memcpy(o->value, saved[i].value, size_of_kind(o->kind));
        if (o->given)
            *o->given = saved[i].given;
    }
}

static const cli_option *find_option(const cli_group *groups, const char *name)
{
    for (const cli_group *group = groups; group->title; group++)
        for (const cli_option *o = group->options; o->name; o++)
            if (!strcmp(o->name, name) && (!o->unrecorded || o->unrecorded == CLI_SCENE_ONLY))
                return o;
    return NULL;
}

static void store_options(const cli_group *groups, const shape_scene_options *options, const char *program,
                          const char *place)
{
    for (size_t i = 0; i < options->count; i++) {
        const char *name = options->items[i].name, *text = options->items[i].text;
        cli_set_place("%s.%s: ", place, name);
        const cli_option *option = find_option(groups, name);
        if (!option)
            cli_fail("there is no such option (%s --help names them)", program);
        if (option->kind == CLI_FLAG && text)
            cli_fail("--%s is a flag (write true, or leave it out)", name);
        if (option->kind != CLI_FLAG && !text)
            cli_fail("--%s takes a value, not true", name);
        cli_store(option, text ? text : "");
        cli_record_option(option, text);
    }
}

shape_set *cli_generator_run(const cli_generator *generator, const char *input,
                             const shape_scene_options *options, const char *place)
{
    static uint64_t seed; /* static: the record points at its row */
    static const cli_option seed_options[] = {
        {"seed", 0, CLI_SEED, &seed, 0, 0, "N", "as in every program [1]", NULL, false}, {0}};
    cli_group groups[8] = {{0}};
    int count = 0;
    for (const cli_group *group = generator->groups; group->title && count < 6; group++)
        groups[count++] = *group;
    groups[count] = (cli_group){"Common", seed_options};
    static saved_option saved[CLI_MAX_OPTIONS];
    static cli_record record;
    cli_medium medium = cli_medium_values;
    cli_medium_values = cli_medium_defaults;
    seed = 1;
    int saved_count = save_options(groups, saved);
    cli_record *before = cli_record_use(&record);
    bool quiet = cli_set_quiet(true);
    cli_record_start(generator->name);
    char options_place[512];
    snprintf(options_place, sizeof options_place, "%s.options", place);
    store_options(groups, options, generator->name, options_place);
    cli_set_place("%s: ", place);
    shape_set *set =
        generator->make ? generator->make(input, seed) : cli_generator_spawn(generator, input, options);
    cli_set_place("%s", "");
    cli_set_quiet(quiet);
    cli_record_use(before);
    restore_options(saved, saved_count);
    cli_medium_values = medium;
    return set;
}

void cli_medium_set(const shape_scene_options *options, const char *place)
{
    static const cli_group groups[] = {{"Medium", cli_medium_options}, {0}};
    static cli_record ignored;
    cli_record *before = cli_record_use(&ignored);
    cli_record_start("");
    cli_medium_values = cli_medium_defaults;
    for (size_t i = 0; i < options->count; i++)
        if (!strcmp(options->items[i].name, "at"))
            cli_fail("%s.at: it is a place, not a medium (use \"translate\")", place);
    store_options(groups, options, "neph-gauss", place);
    cli_set_place("%s", "");
    cli_record_use(before);
}

/* --- --save-scene --- */

void cli_generator_save(const cli_generator *generator, const cli_common *common)
{
    if (!cli_save_wanted())
        return;
    const cli_record *record = cli_record_now();
    shape_error error;
    shape_scene_cloud *cloud;
    shape_scene *scene = shape_scene_create(&error);
    if (!scene)
        cli_fail("%s", error.text);
    cli_check(shape_scene_add_cloud(scene, &cloud, &error), &error);
    cli_check(shape_scene_set_text(&cloud->generator, generator->name, &error), &error);
    if (generator->input)
        cloud->input = cli_save_name(common->arguments[0]);
    for (int i = 0; i < record->count; i++) {
        const cli_option *option = record->options[i].option;
        if (!option->unrecorded || option->unrecorded == CLI_SCENE_ONLY)
            cli_check(shape_scene_add_option(&cloud->options, option->name, record->options[i].text, &error),
                      &error);
    }
    cli_save_scene(scene);
    shape_scene_destroy(scene);
}
