/* What is opened on the command line: a scene, a .neph, a grammar or a volume, told apart by what is in it, or what a
 * generator makes, of a mesh or of nothing. Mistakes end the program, one line each. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_volume.h"
#include "entry.h"
#include "setting.h"
#include "shape/file.h"
#include "view.h"

/* One line a mistake, then the end. */
static void fail_lines(char *mistakes)
{
    for (char *line = strtok(mistakes, "\n"); line; line = strtok(NULL, "\n"))
        cli_error("%s", line);
    exit(CLI_FAILED);
}

shape_set *view_open_source(const char *path, const view_generator *generator)
{
    shape_error error;
    view_contents contents;
    static char mistakes[16384];
    if (view_source_read(path, generator, NULL, NULL, false, &contents, mistakes, sizeof mistakes, &error))
        fail_lines(mistakes);
    return contents.set;
}

/* A volume has been read into the set. */
static view_opened open_volume(view_opened opened)
{
    if (cli_save_wanted())
        cli_fail("%s: a scene holds no volume (make primitives of it by neph-vdb first)", opened.input.path);
    opened.input.volume = opened.volume = true;
    return opened;
}

view_opened view_open(const char *path, const view_generator *generator)
{
    view_opened opened = {.input = {.path = path}, .used = *generator};
    view_generator own = generator->which < 0 ? view_generator_of_path(path, generator->seed) : *generator;
    view_contents contents;
    cli_input *input = &opened.input;
    const char *shown = strcmp(path, "-") ? path : "standard input";
    unsigned char *bytes;
    shape_error error;
    static char mistakes[16384];
    if (own.which >= 0 && strcmp(view_generator_program(&own), "neph-lsys")) {
        if (view_source_read(path, &own, NULL, NULL, false, &contents, mistakes, sizeof mistakes, &error))
            fail_lines(mistakes);
        input->set = contents.set;
        opened.used = contents.used;
        return opened;
    }
    if (cli_is_volume(path)) {
        input->set = cli_read_volume(path);
        return open_volume(opened);
    }
    cli_check(shape_file_read(path, 0x40000000, &bytes, &input->size, &error), &error);
    if (cli_is_volume_bytes(bytes, input->size)) {
        input->set = cli_read_volume_bytes(shown, bytes, input->size);
        free(bytes);
        return open_volume(opened);
    }
    if (shape_scene_is(bytes, input->size)) {
        cli_check(shape_scene_decode(bytes, input->size, shown, &input->scene, &error), &error);
        input->set = cli_scene_make(input->scene, path);
        opened.scene = true;
        opened.used = view_entry_generator(input->scene);
        view_source_fill_entry(input->scene, path, &opened.used);
    } else {
        if (view_source_decode(path, bytes, input->size, &own, NULL, &contents, mistakes, sizeof mistakes,
                               &error))
            fail_lines(mistakes);
        input->set = contents.set;
        opened.used = contents.used;
        opened.used.seed = generator->seed;
    }
    free(bytes);
    return opened;
}
