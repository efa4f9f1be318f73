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

cli_input cli_input_read(const char *path)
{
    cli_input input = {.path = path};
    shape_error error;
    unsigned char *bytes;
    const char *shown = strcmp(path, "-") ? path : "standard input";
    cli_check(shape_file_read(path, MAX_INPUT_FILE, &bytes, &input.size, &error), &error);
    cli_note_input(path, bytes, input.size);
    size_t length = strlen(path);
    bool json = length > 5 && !strcmp(path + length - 5, ".json");
    if (json || shape_scene_is(bytes, input.size)) {
        read_scene(&input, bytes, shown);
    } else {
        if (shape_neph_decode(bytes, input.size, &input.set, &error))
            cli_fail("%s: %s", shown, error.text);
        shape_neph_version(bytes, &input.major, &input.minor);
    }
    free(bytes);
    return input;
}

void cli_input_free(cli_input *input)
{
    shape_set_destroy(input->set);
    shape_scene_destroy(input->scene);
}
