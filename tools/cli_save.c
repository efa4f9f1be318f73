/* The options of scenes, and writing one: --save-scene. */
#include <stdlib.h>
#include <string.h>

#include "cli_scene.h"
#include "shape/file.h"

static bool allow_outside;
static const char *save_path;

static const char save_help[] = "write a scene (docs/scene.md) that makes this again [none]";

const cli_option cli_save_options[] = {
    {"save-scene", 0, CLI_TEXT, &save_path, 0, 0, "FILE", save_help, NULL, true}, {0}};

#define OUTSIDE_ROW                                                                                          \
    {                                                                                                        \
        "allow-outside", 0, CLI_FLAG, &allow_outside, 0, 0, NULL,                                            \
            "a scene may name files outside its folder [off]", NULL, true                                    \
    }

const cli_option cli_outside_options[] = {OUTSIDE_ROW, {0}};

const cli_option cli_scene_options[] = {
    {"save-scene", 0, CLI_TEXT, &save_path, 0, 0, "FILE", save_help, NULL, true}, OUTSIDE_ROW, {0}};

bool cli_outside_allowed(void)
{
    return allow_outside;
}

const char *cli_save_path(void)
{
    return save_path;
}

bool cli_save_wanted(void)
{
    return save_path != NULL;
}

void cli_save_check(const cli_common *common)
{
    if (!save_path)
        return;
    if (!*save_path || !strcmp(save_path, "-"))
        cli_wrong("--save-scene needs a file's name");
    for (int i = 0; i < common->argument_count; i++)
        if (!strcmp(common->arguments[i], "-"))
            cli_wrong("--save-scene: a scene cannot name standard input (name the file)");
}

void cli_save_scene(const shape_scene *scene)
{
    shape_error error;
    char *text;
    size_t size;
    cli_check(shape_scene_encode(scene, &text, &size, &error), &error);
    cli_check(shape_file_write(save_path, text, size, &error), &error);
    free(text);
}

char *cli_save_name(const char *path)
{
    shape_error error;
    char *name;
    bool outside;
    cli_check(shape_scene_relative(save_path, path, &name, &outside, &error), &error);
    if (outside)
        cli_say("note: %s lies outside the folder of %s, which can be read with --allow-outside only", path,
                save_path);
    return name;
}
