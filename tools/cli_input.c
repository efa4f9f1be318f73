/* Inputs of programs that show or change clouds: a .neph, or a scene, told apart by what is in them. */
#include <stdlib.h>
#include <string.h>

#include "cli_scene.h"
#include "shape/file.h"
#include "shape/neph.h"

enum { MAX_INPUT_FILE = 0x40000000 };

static void read_scene(cli_input *input, const unsigned char *bytes, const char *shown)
{
    shape_error error;
    cli_check(shape_scene_decode(bytes, input->size, shown, &input->scene, &error), &error);
    input->set = cli_scene_make(input->scene, input->path);
}

cli_input cli_input_decode(const char *path, const unsigned char *bytes, size_t size)
{
    cli_input input = {.path = path, .size = size};
    shape_error error;
    const char *shown = strcmp(path, "-") ? path : "standard input";
    size_t length = strlen(path);
    bool json = length > 5 && !strcmp(path + length - 5, ".json");
    cli_note_input(path, bytes, size);
    if (json || shape_scene_is(bytes, size)) {
        read_scene(&input, bytes, shown);
    } else {
        if (shape_neph_decode(bytes, size, &input.set, &error))
            cli_fail("%s: %s", shown, error.text);
        shape_neph_version(bytes, &input.major, &input.minor);
    }
    return input;
}

cli_input cli_input_read(const char *path)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_file_read(path, MAX_INPUT_FILE, &bytes, &size, &error), &error);
    cli_input input = cli_input_decode(path, bytes, size);
    free(bytes);
    return input;
}

void cli_input_free(cli_input *input)
{
    shape_set_destroy(input->set);
    shape_scene_destroy(input->scene);
}

void cli_note_meshes(const shape_scene *scene, const char *what)
{
    if (scene && scene->mesh_count)
        cli_say("note: meshes of the scene are %s (neph-render draws them)", what);
}
